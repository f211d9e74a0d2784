#include "daemon/http/request_handler.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include <httplib.h>

namespace rayloc {
namespace {

// A request that is in memory, and the answer as it is written.
class MemoryStream : public httplib::Stream {
 public:
  explicit MemoryStream(const std::string& request) : request_(request) {}

  bool is_readable() const override { return at_ < request_.size(); }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, size_t size) override {
    const std::size_t count = std::min(size, request_.size() - at_);
    std::memcpy(to, request_.data() + at_, count);
    at_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, size_t size) override {
    answer_.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return INVALID_SOCKET; }

  std::string take_answer() { return std::move(answer_); }

 private:
  const std::string& request_;
  std::size_t at_ = 0;
  std::string answer_;
};

// Equal in a time that does not tell how far they agree.
bool same_secret(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |=
        static_cast<unsigned char>(a[i]) ^
        static_cast<unsigned>(static_cast<unsigned char>(b.empty() ? '\0' : b[i % b.size()]));
  }
  return difference == 0;
}

// "127.0.0.1:8480", "[::1]", "localhost": not a name that somebody else's server gave an address.
bool names_no_domain(const std::string& host) {
  std::string name =
      host.substr(0, host.rfind(']') == std::string::npos ? host.find(':') : host.rfind(']') + 1);
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') {
    name = name.substr(1, name.size() - 2);
  }
  in6_addr address{};
  return name.empty() || name == "localhost" || inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

// Sent with every answer. The policy is that of the map (map_files.h), and no answer needs more.
const httplib::Headers kHeaders = {
    {"Cache-Control", "no-store"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"}};

std::string header_lines() {
  std::string lines;
  for (const auto& [name, value] : kHeaders) {
    lines.append(name).append(": ").append(value).append("\r\n");
  }
  return lines;
}

std::string head_of_stream() {
  return "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n" +
         header_lines() + "\r\n";
}

bool has_body(const httplib::Request& request) {
  const std::string length = request.get_header_value("Content-Length");
  return request.has_header("Transfer-Encoding") || (!length.empty() && length != "0");
}

void set_json(httplib::Response& response, int status, const std::string& reason) {
  response.status = status;
  response.set_content(R"({"error":")" + reason + "\"}\n", "application/json");
}

}  // namespace

class RequestHandler::Parser : public httplib::Server {
 public:
  Parser(std::map<std::string, HttpRoute> routes, std::string token)
      : routes_(std::move(routes)), token_(std::move(token)) {
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      route(request, response);
      return HandlerResponse::Handled;
    });
    // Answers to what was wrong before a route was looked for.
    set_error_handler([](const httplib::Request&, httplib::Response& response) {
      if (response.body.empty()) {
        set_json(response, response.status, "refused");
      }
    });
    set_default_headers(kHeaders);
  }

  HttpAnswer answer(const std::string& head) {
    MemoryStream stream(head);
    bool closed = false;
    status_ = 400;
    events_ = nullptr;
    process_request(stream, true, closed, [](httplib::Request&) {});
    if (events_) {
      return {200, head_of_stream(), std::move(events_), std::move(last_event_id_)};
    }
    HttpAnswer answer{status_, stream.take_answer()};
    constexpr std::string_view kVersion = "HTTP/1.1 ";
    if (answer.bytes.size() > kVersion.size() + 3) {
      answer.status = std::atoi(answer.bytes.c_str() + kVersion.size());
    }
    return answer;
  }

 private:
  void route(const httplib::Request& request, httplib::Response& response) {
    if (has_body(request)) {
      return set_json(response, 413, "no request here has a body");
    }
    if (request.method != "GET" && request.method != "HEAD" && request.method != "POST") {
      response.set_header("Allow", "GET, HEAD, POST");
      return set_json(response, 405, "GET, HEAD and POST only");
    }
    if (token_.empty() && !names_no_domain(request.get_header_value("Host"))) {
      return set_json(response, 421, "address this server by its number or as localhost");
    }
    const auto found = routes_.find(request.path);
    if (found == routes_.end()) {
      return set_json(response, 404, "no such path");
    }
    const HttpRoute& route = found->second;
    const bool post = request.method == "POST";
    const bool post_only = route.method == "POST";
    if (post != post_only && !(post && route.control)) {
      response.set_header("Allow", post_only ? "POST" : "GET, HEAD");
      return set_json(response, 405, post_only ? "POST only" : "GET and HEAD only");
    }
    if (post && !may_change(route, request, response)) {
      return;
    }
    if (!found->second.open && !token_.empty() && !is_authorized(request)) {
      response.set_header("WWW-Authenticate", "Bearer");
      response.set_header("WWW-Authenticate", "Basic realm=\"user rayloc, password: the token\"");
      return set_json(response, 401, "a bearer token is needed");
    }
    if (found->second.events) {
      if (request.method == "GET") {
        events_ = found->second.events;
        last_event_id_ = request.get_header_value("Last-Event-ID");
      }
      return response.set_content("", "text/event-stream");
    }
    const HttpReply reply = post && route.control ? route.control(request.params) : route.handler();
    response.status = reply.status;
    response.set_content(reply.body, reply.content_type);
  }

  // A page of another server cannot do it in the name of who looks at it.
  static bool may_change(const HttpRoute& route,
                         const httplib::Request& request,
                         httplib::Response& response) {
    const std::string origin = request.get_header_value("Origin");
    const std::string host = request.get_header_value("Host");
    const bool ours = !host.empty() && (origin == "http://" + host || origin == "https://" + host);
    if (request.has_header("Origin") && !(route.control && ours)) {
      set_json(response, 403, "not from a page of the web");
      return false;
    }
    if (route.control && !request.has_header(kControlHeader)) {
      set_json(response, 403, std::string("say that it is meant: ") + kControlHeader + ": 1");
      return false;
    }
    return true;
  }

  // A browser has no way to send a bearer token with what a page loads, but asks for a password.
  bool is_authorized(const httplib::Request& request) const {
    const std::string given = request.get_header_value("Authorization");
    const bool bearer = same_secret(given, "Bearer " + token_);
    const bool basic =
        same_secret(given, httplib::make_basic_authentication_header("rayloc", token_).second);
    return bearer || basic;
  }

  const std::map<std::string, HttpRoute> routes_;
  const std::string token_;
  int status_ = 0;
  // Of the answer that is being made.
  std::shared_ptr<EventFeed> events_;
  std::string last_event_id_;
};

RequestHandler::RequestHandler(std::map<std::string, HttpRoute> routes, std::string token)
    : parser_(std::make_unique<Parser>(std::move(routes), std::move(token))) {}
RequestHandler::~RequestHandler() = default;

HttpAnswer RequestHandler::answer(const std::string& head) { return parser_->answer(head); }

HttpAnswer RequestHandler::refusal(int status,
                                   const std::string& reason,
                                   const std::string& headers) {
  const std::string body = R"({"error":")" + reason + "\"}\n";
  return {status,
          "HTTP/1.1 " + std::to_string(status) + " " + reason +
              "\r\nConnection: close\r\nContent-Type: application/json\r\n" + header_lines() +
              headers + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body};
}

}  // namespace rayloc
