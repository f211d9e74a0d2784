#include "daemon/live/http/request_handler.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include <httplib.h>

namespace rayloc {
namespace {

// A request in memory, and the answer being written.
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

// Compares in a time that does not depend on the number of equal characters.
bool same_secret(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |=
        static_cast<unsigned char>(a[i]) ^
        static_cast<unsigned>(static_cast<unsigned char>(b.empty() ? '\0' : b[i % b.size()]));
  }
  return difference == 0;
}

// "127.0.0.1:8480", "[::1]", "localhost": not a domain that a foreign server gave an address.
bool names_no_domain(const std::string& host) {
  std::string name = host_name(host);
  if (name.size() > 2 && name.front() == '[' && name.back() == ']') {
    name = name.substr(1, name.size() - 2);
  }
  in6_addr address{};
  return name.empty() || name == "localhost" || inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

std::vector<WebOrigin> origins_of(const HttpFront& front) {
  std::vector<WebOrigin> origins;
  for (const std::string& one : front.origins) {
    if (const std::optional<WebOrigin> origin = parse_origin(one)) {
      origins.push_back(*origin);
    }
  }
  return origins;
}

std::string frame_ancestors(const HttpFront& front) {
  std::string list;
  for (const std::string& one : front.frame_ancestors) {
    if (is_frame_ancestor(one)) {
      list += one == "self" ? " 'self'" : " " + one;
    }
  }
  return list.empty() ? " 'none'" : list;
}

constexpr const char* kPolicy = "Content-Security-Policy";

// Sent with every answer. The policy is the map's (map_files.h), and suffices for all answers.
httplib::Headers headers_of(const HttpFront& front) {
  return {{"Cache-Control", "no-store"},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {kPolicy,
           "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
           "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors" +
               frame_ancestors(front)}};
}

// Policy of a page with its own styles: it may neither run scripts nor send requests.
std::string policy_of_report(const HttpFront& front) {
  return "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; "
         "frame-ancestors" +
         frame_ancestors(front);
}

std::string lines_of(const httplib::Headers& headers) {
  std::string lines;
  for (const auto& [name, value] : headers) {
    lines.append(name).append(": ").append(value).append("\r\n");
  }
  return lines;
}

// Servers between us and the viewer would otherwise buffer events until there are enough of them to
// send or compress.
std::string head_of_stream(httplib::Headers headers) {
  headers.erase("Cache-Control");
  headers.insert({{"Cache-Control", "no-store, no-transform"}, {"X-Accel-Buffering", "no"}});
  return "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nConnection: close\r\n" +
         lines_of(headers) + "\r\n";
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
  using Routes = std::map<std::string, HttpRoute>;

  Parser(std::map<std::string, HttpRoute> routes, std::string token, const HttpFront& front)
      : routes_(std::make_shared<const Routes>(std::move(routes))),
        token_(std::move(token)),
        base_path_(parse_base_path(front.base_path).value_or("")),
        origins_(origins_of(front)),
        headers_(headers_of(front)),
        policy_of_report_(policy_of_report(front)) {
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      route(request, response);
      return HandlerResponse::Handled;
    });
    // Answers to errors found before a route was searched.
    set_error_handler([](const httplib::Request&, httplib::Response& response) {
      if (response.body.empty()) {
        set_json(response, response.status, "refused");
      }
    });
    set_default_headers(headers_);
  }

  void set_routes(std::map<std::string, HttpRoute> routes) {
    auto shared = std::make_shared<const Routes>(std::move(routes));
    const std::lock_guard lock(mutex_);
    routes_.swap(shared);
  }

  HttpAnswer answer(const std::string& head, const std::string* body) {
    MemoryStream stream(head);
    bool closed = false;
    status_ = 400;
    events_ = nullptr;
    body_ = body;
    awaits_ = 0;
    process_request(stream, true, closed, [](httplib::Request&) {});
    if (events_) {
      return {200, head_of_stream(headers_), std::move(events_), std::move(last_event_id_)};
    }
    if (awaits_ > 0) {
      return {status_, "", nullptr, "", awaits_};
    }
    HttpAnswer answer{status_, stream.take_answer()};
    constexpr std::string_view kVersion = "HTTP/1.1 ";
    if (answer.bytes.size() > kVersion.size() + 3) {
      answer.status = std::atoi(answer.bytes.c_str() + kVersion.size());
    }
    return answer;
  }

  const httplib::Headers& headers() const { return headers_; }

 private:
  void route(const httplib::Request& request, httplib::Response& response) {
    const std::shared_ptr<const Routes> routes = current_routes();
    const HttpRoute* const found = route_of(*routes, request);
    if (has_body(request) && (found == nullptr || !found->receive)) {
      return set_json(response, 413, "no request here has a body");
    }
    if (request.method != "GET" && request.method != "HEAD" && request.method != "POST") {
      response.set_header("Allow", "GET, HEAD, POST");
      return set_json(response, 405, "GET, HEAD and POST only");
    }
    if (token_.empty() && !is_ours(request.get_header_value("Host"))) {
      return set_json(response,
                      421,
                      "address this server by its number or as localhost, or list the name in "
                      "[http] origins");
    }
    if (found == nullptr) {
      return at_no_route(request, response);
    }
    const HttpRoute& route = *found;
    const bool post = request.method == "POST";
    const bool post_only = route.method == "POST";
    if (post != post_only && !(post && changes_by_page(route))) {
      response.set_header("Allow", post_only ? "POST" : "GET, HEAD");
      return set_json(response, 405, post_only ? "POST only" : "GET and HEAD only");
    }
    if (post && !may_change(route, request, response)) {
      return;
    }
    if (!route.open && !token_.empty() && !is_authorized(request)) {
      response.set_header("WWW-Authenticate", "Bearer");
      response.set_header("WWW-Authenticate", "Basic realm=\"user rayloc, password: the token\"");
      return set_json(response, 401, "a bearer token is needed");
    }
    if (route.events) {
      if (request.method == "GET") {
        events_ = route.events;
        last_event_id_ = request.get_header_value("Last-Event-ID");
      }
      return response.set_content("", "text/event-stream");
    }
    if (post && route.receive) {
      return receive(route, request, response);
    }
    const HttpReply reply = post && route.control ? route.control(request.params) : route.handler();
    response.status = reply.status;
    response.set_content(reply.body, reply.content_type);
    if (reply.own_styles) {
      response.headers.erase(kPolicy);
      response.set_header(kPolicy, policy_of_report_);
    }
  }

  static bool changes_by_page(const HttpRoute& route) { return route.control || route.receive; }

  // Requests the body, or passes it to the route's receiver.
  void receive(const HttpRoute& route,
               const httplib::Request& request,
               httplib::Response& response) {
    const std::string type = request.get_header_value("Content-Type");
    if (type.substr(0, type.find(';')) != route.content_type) {
      return set_json(response, 415, "Content-Type must be " + route.content_type);
    }
    const std::string stated = request.get_header_value("Content-Length");
    std::size_t length = 0;
    const auto read = std::from_chars(stated.data(), stated.data() + stated.size(), length);
    if (request.has_header("Transfer-Encoding") || stated.empty() || read.ec != std::errc() ||
        read.ptr != stated.data() + stated.size()) {
      return set_json(response, 411, "state the Content-Length");
    }
    if (length > route.most_bytes) {
      return set_json(
          response, 413, "at most " + std::to_string(route.most_bytes) + " bytes are taken here");
    }
    if (body_ == nullptr && length > 0) {
      awaits_ = length;
      return;
    }
    static const std::string kNone;
    const HttpReply reply = route.receive(request.params, body_ == nullptr ? kNone : *body_);
    response.status = reply.status;
    response.set_content(reply.body, reply.content_type);
  }

  const HttpRoute* route_of(const Routes& routes, const httplib::Request& request) const {
    const HttpRoute* const found = route_at(routes, request.path);
    const std::string alias =
        found != nullptr && found->alias ? found->alias(request.params) : std::string();
    const auto other = alias.empty() ? routes.end() : routes.find(alias);
    return other == routes.end() ? found : &other->second;
  }

  // The route at the path itself, for direct clients, and below the base path.
  const HttpRoute* route_at(const Routes& routes, const std::string& path) const {
    auto found = routes.find(path);
    if (found == routes.end() && !base_path_.empty() && path.rfind(base_path_ + "/", 0) == 0) {
      found = routes.find(path.substr(base_path_.size()));
    }
    return found == routes.end() ? nullptr : &found->second;
  }

  // The addresses within the page are relative, so it must be requested with a '/' at the
  // end.
  void at_no_route(const httplib::Request& request, httplib::Response& response) const {
    if (base_path_.empty() || request.path != base_path_ || request.method == "POST") {
      return set_json(response, 404, "no such path");
    }
    constexpr int kMoved = 308;
    const std::string last = base_path_.substr(base_path_.rfind('/') + 1);
    response.set_header("Location", last + "/");
    set_json(response, kMoved, "with a / at the end");
  }

  bool is_ours(const std::string& host) const {
    return names_no_domain(host) ||
           std::any_of(origins_.begin(), origins_.end(), [&](const WebOrigin& one) {
             return one.host == host_name(host);
           });
  }

  // True for a page that we sent, under any name that the browser uses for us. A server before us
  // may have written its own `Host`.
  bool is_from_our_page(const httplib::Request& request) const {
    const std::string text = request.get_header_value("Origin");
    const std::string host = request.get_header_value("Host");
    if (!host.empty() && (text == "http://" + host || text == "https://" + host)) {
      return true;
    }
    const std::optional<WebOrigin> origin = parse_origin(text);
    return origin && (request.get_header_value("Sec-Fetch-Site") == "same-origin" ||
                      std::find(origins_.begin(), origins_.end(), *origin) != origins_.end());
  }

  // A page of another server must not change state on behalf of the person who views it.
  bool may_change(const HttpRoute& route,
                  const httplib::Request& request,
                  httplib::Response& response) const {
    const bool by_page = changes_by_page(route);
    if (request.has_header("Origin") && !(by_page && is_from_our_page(request))) {
      set_json(response,
               403,
               by_page ? "not from a page of the web; where the map is behind another server, "
                         "list its address in [http] origins"
                       : "not from a page of the web");
      return false;
    }
    if (by_page && !request.has_header(kControlHeader)) {
      set_json(response,
               403,
               std::string("confirm the request with the header ") + kControlHeader + ": 1");
      return false;
    }
    return true;
  }

  // A browser cannot send a bearer token with a page's requests, but asks for a password.
  bool is_authorized(const httplib::Request& request) const {
    const std::string given = request.get_header_value("Authorization");
    const bool bearer = same_secret(given, "Bearer " + token_);
    const bool basic =
        same_secret(given, httplib::make_basic_authentication_header("rayloc", token_).second);
    return bearer || basic;
  }

  std::shared_ptr<const Routes> current_routes() const {
    const std::lock_guard lock(mutex_);
    return routes_;
  }

  mutable std::mutex mutex_;
  std::shared_ptr<const Routes> routes_;  // guarded by mutex_
  const std::string token_;
  const std::string base_path_;
  const std::vector<WebOrigin> origins_;
  const httplib::Headers headers_;
  const std::string policy_of_report_;
  int status_ = 0;
  // Body of the request being answered.
  const std::string* body_ = nullptr;  // null: it has not been read
  std::size_t awaits_ = 0;
  std::shared_ptr<EventFeed> events_;
  std::string last_event_id_;
};

RequestHandler::RequestHandler(std::map<std::string, HttpRoute> routes,
                               std::string token,
                               const HttpFront& front)
    : parser_(std::make_unique<Parser>(std::move(routes), std::move(token), front)) {}
RequestHandler::~RequestHandler() = default;

void RequestHandler::set_routes(std::map<std::string, HttpRoute> routes) {
  parser_->set_routes(std::move(routes));
}

HttpAnswer RequestHandler::answer(const std::string& head, const std::string* body) {
  return parser_->answer(head, body);
}

HttpAnswer RequestHandler::refusal(int status,
                                   const std::string& reason,
                                   const std::string& headers) const {
  const std::string body = R"({"error":")" + reason + "\"}\n";
  return {status,
          "HTTP/1.1 " + std::to_string(status) + " " + reason +
              "\r\nConnection: close\r\nContent-Type: application/json\r\n" +
              lines_of(parser_->headers()) + headers +
              "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body};
}

}  // namespace rayloc
