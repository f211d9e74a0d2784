// Real sockets, and clients that ask for what they should not.
#include "daemon/live/http/http_server.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/live/http/http_client.h"
#include "tests/support/eventually.h"

namespace rayloc::http_server_test {
namespace {

using ::testing::EndsWith;
using testing::expect_policy;
using ::testing::HasSubstr;
using testing::http_get;
using testing::HttpClient;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};

class HttpServerTest : public ::testing::Test {
 protected:
  void start(HttpServer::Options options = {}) {
    std::map<std::string, HttpRoute> routes;
    routes["/open"] = {[] { return HttpReply{200, "text/plain", "fine\n"}; }, true};
    routes["/secret"] = {[] { return HttpReply{200, "text/plain", "here\n"}; }};
    routes["/report"] = {[] { return HttpReply{200, "text/html", "<style></style>", true}; }};
    routes["/large"] = {[] { return HttpReply{200, "text/plain", std::string(32 << 20, 'x')}; }};
    routes["/change"] = {[] {
                           return HttpReply{202, "text/plain", "done\n"};
                         },
                         false,
                         nullptr,
                         "POST"};
    routes["/control"] = {.handler =
                              [] {
                                return HttpReply{200, "text/plain", "as it is\n"};
                              },
                          .control =
                              [](const HttpParameters& parameters) {
                                std::string text;
                                for (const auto& [key, value] : parameters) {
                                  text.append(key).append("=").append(value).append("\n");
                                }
                                return HttpReply{200, "text/plain", text};
                              }};
    routes["/of"] = {.handler =
                         [] {
                           return HttpReply{404, "text/plain", "name one\n"};
                         },
                     .alias =
                         [](const HttpParameters& parameters) {
                           const auto one = parameters.find("one");
                           return one == parameters.end() ? std::string() : "/" + one->second;
                         }};
    HttpRoute& written = routes["/written"];
    written.handler = [] { return HttpReply{200, "text/plain", "as it is\n"}; };
    written.receive = [](const HttpParameters&, const std::string& body) {
      return HttpReply{200, "text/plain", std::to_string(body.size()) + " bytes\n"};
    };
    written.most_bytes = std::size_t{1} << 20U;
    auto opened = HttpServer::open(options, std::move(routes));
    ASSERT_TRUE(opened) << opened.error().message;
    server_ = std::move(*opened);
    server_->start();
  }
  std::string answer_to(const std::string& request) const {
    const HttpClient client(server_->port());
    client.send(request);
    return client.receive();
  }

  std::atomic<int> rounds_ = 0;  // of the server's thread, which ends with server_
  std::unique_ptr<HttpServer> server_;
};

TEST_F(HttpServerTest, AnswersRequestsForExistingPaths) {
  start();
  const std::string answer = http_get(server_->port(), "/open?x=1");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("Content-Length: 5\r\n"));
  EXPECT_THAT(answer, HasSubstr("X-Content-Type-Options: nosniff\r\n"));
  EXPECT_THAT(answer, EndsWith("\r\n\r\nfine\n"));
  EXPECT_THAT(answer_to("HEAD /open HTTP/1.1\r\n\r\n"), EndsWith("\r\n\r\n"));
  EXPECT_EQ(server_->counters().requests.at(200), 2U);
}

// Only where a route takes a body, of its type, of our own page, and not too long.
TEST_F(HttpServerTest, TakesBodiesWhereARouteDoes) {
  start();
  const std::string body(200'000, 'x');
  const std::string length = "Content-Length: " + std::to_string(body.size()) + "\r\n";
  const std::string right = "Content-Type: application/json\r\nX-RayLoc-Control: 1\r\n";
  const auto post = [](const std::string& path, const std::string& headers) {
    return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n";
  };
  EXPECT_THAT(answer_to(post("/written", right + length) + body),
              EndsWith("\r\n\r\n200000 bytes\n"));
  EXPECT_THAT(answer_to(post("/written", right + "Content-Length: 0\r\n")), EndsWith("0 bytes\n"));
  EXPECT_THAT(http_get(server_->port(), "/written"), EndsWith("as it is\n"));
  // None of these waits for the body.
  EXPECT_THAT(answer_to(post("/control", right + length)), StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to(post("/written", right + "Content-Length: 1048577\r\n")),
              StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to(post("/written", right + "Content-Length: 1x\r\n")),
              StartsWith("HTTP/1.1 411 "));
  EXPECT_THAT(answer_to(post("/written", right + "Transfer-Encoding: chunked\r\n")),
              StartsWith("HTTP/1.1 411 "));
  EXPECT_THAT(answer_to(post("/written", "X-RayLoc-Control: 1\r\n" + length)),
              StartsWith("HTTP/1.1 415 "));
  EXPECT_THAT(answer_to(post("/written", "Content-Type: application/json\r\n" + length)),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(answer_to(post("/written", right + length + "Origin: http://elsewhere.example\r\n")),
              StartsWith("HTTP/1.1 403 "));
}

// One refused connection takes no memory of the others, and the sum is free again afterwards.
TEST_F(HttpServerTest, LimitsTheBodiesThatItAwaitsTogether) {
  HttpServer::Options options;
  options.limits.awaited_bytes = 1000;
  options.limits.small_body = 10;
  start(options);
  const auto head = [](int length) {
    return "POST /written HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
           "X-RayLoc-Control: 1\r\nContent-Length: " +
           std::to_string(length) + "\r\n\r\n";
  };
  const HttpClient first(server_->port());
  ASSERT_TRUE(first.send(head(600)));
  // Heads are read in any order of the connections: the request below is refused once the first
  // one is awaited.
  std::string refused;
  EXPECT_TRUE(eventually(kPatience, [&] {
    refused = answer_to(head(401) + std::string(401, 'x'));
    return refused.rfind("HTTP/1.1 503 ", 0) == 0;
  })) << refused;
  EXPECT_THAT(refused, HasSubstr("\r\nRetry-After: "));
  EXPECT_GE(server_->counters().requests.at(503), 1U);
  EXPECT_THAT(answer_to(head(400) + std::string(400, 'x')), EndsWith("400 bytes\n"));
  EXPECT_THAT(answer_to(head(10) + std::string(10, 'x')), EndsWith("10 bytes\n"));
  ASSERT_TRUE(first.send(std::string(600, 'x')));
  EXPECT_THAT(first.receive(), EndsWith("600 bytes\n"));
  EXPECT_THAT(answer_to(head(1000) + std::string(1000, 'x')), EndsWith("1000 bytes\n"));
}

// The body of a request without permission uses no memory.
TEST_F(HttpServerTest, AsksForTheTokenBeforeTheBody) {
  HttpServer::Options options;
  options.token = "a-token-that-is-long-enough";
  start(options);
  const std::string head =
      "POST /written HTTP/1.1\r\nContent-Type: application/json\r\nX-RayLoc-Control: 1\r\n"
      "Content-Length: 5\r\n";
  EXPECT_THAT(answer_to(head + "\r\n"), StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(answer_to(head + "Authorization: Bearer " + options.token + "\r\n\r\nhello"),
              EndsWith("5 bytes\n"));
}

// A client that waits for a descriptor costs no processor time, and is answered once one is free.
TEST_F(HttpServerTest, WaitsWithoutCpuTimeWhenDescriptorsRunOut) {
  HttpServer::Options options;
  options.on_round = [this] { ++rounds_; };
  start(options);
  const int next = dup(STDIN_FILENO);
  close(next);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit one_more{static_cast<rlim_t>(next) + 1, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &one_more), 0);
  const HttpClient client(server_->port());  // takes the last one
  // It rests for 100 ms in every second round. Without a rest, rounds take microseconds; a busy
  // machine makes them longer only.
  const auto begin = std::chrono::steady_clock::now();
  const bool came_round =
      eventually(kPatience, [&, first = rounds_.load()] { return rounds_ >= first + 20; });
  const auto took = std::chrono::steady_clock::now() - begin;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  ASSERT_TRUE(came_round);
  ASSERT_TRUE(client.connected());
  EXPECT_GT(took, std::chrono::milliseconds(500));
  EXPECT_TRUE(server_->counters().requests.empty());
  client.send("GET /open HTTP/1.1\r\n\r\n");
  EXPECT_THAT(client.receive(), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServerTest, SendsALargeAnswerToAClientThatReadsInPieces) {
  HttpServer::Options options;
  options.limits.time = test::patient(kPatience);  // for fetching it, on a machine that is busy
  start(options);
  const HttpClient client(server_->port());
  client.send("GET /large HTTP/1.1\r\n\r\n");
  // It is more than the kernel holds: the server has begun to send it, and waits for the client.
  ASSERT_TRUE(eventually(kPatience, [&] { return server_->counters().requests.count(200) == 1; }));
  EXPECT_EQ(testing::http_body(client.receive()).size(), std::size_t{32} << 20U);
}

// The route that the alias names answers, with its own method and token.
TEST_F(HttpServerTest, AnAliasAnswersAsTheRouteThatItNames) {
  HttpServer::Options options;
  options.token = "token";
  options.front.base_path = "/rayloc";
  start(options);
  const std::string token = "Authorization: Bearer token\r\n";
  for (const std::string base : {"", "/rayloc"}) {
    const auto get = [&](const std::string& query, const std::string& headers) {
      return answer_to("GET " + base + "/of" + query + " HTTP/1.1\r\n" + headers + "\r\n");
    };
    EXPECT_THAT(get("?one=secret", token), EndsWith("here\n"));
    EXPECT_THAT(get("?one=open", ""), EndsWith("fine\n"));
    EXPECT_THAT(get("?one=secret", ""), StartsWith("HTTP/1.1 401 "));
    EXPECT_THAT(get("?one=change", token), StartsWith("HTTP/1.1 405 "));
    EXPECT_THAT(get("?one=none", token), EndsWith("name one\n"));
    EXPECT_THAT(get("", token), EndsWith("name one\n"));
  }
}

// Controls accept requests of our own pages, and of programs that send the control header.
TEST_F(HttpServerTest, IsControlledByItsOwnPagesAlone) {
  start();
  const auto post = [&](const std::string& headers) {
    return answer_to("POST /control?speed=2&position=1.5 HTTP/1.1\r\n" + headers + "\r\n");
  };
  const std::string meant = std::string(kControlHeader) + ": 1\r\n";
  const std::string host = "127.0.0.1:" + std::to_string(server_->port());
  EXPECT_THAT(post(meant), EndsWith("\r\n\r\nposition=1.5\nspeed=2\n"));
  const auto from = [&](const std::string& origin) {
    std::string headers = "Host: ";
    return headers.append(host).append("\r\nOrigin: ").append(origin).append("\r\n");
  };
  const std::string here = "http://" + host;
  EXPECT_THAT(post(from(here) + meant), StartsWith("HTTP/1.1 200 "));
  for (const std::string& headers : {std::string(),
                                     from(here),
                                     from("http://127.0.0.1:1") + meant,
                                     from("http://evil.example") + meant,
                                     from("null") + meant,
                                     "Origin: http://\r\n" + meant}) {
    const std::string answer = post(headers);
    EXPECT_TRUE(answer.rfind("HTTP/1.1 403 ", 0) == 0) << headers << answer;
  }
  EXPECT_THAT(answer_to("GET /control HTTP/1.1\r\n\r\n"), EndsWith("as it is\n"));
  EXPECT_THAT(answer_to("POST /open HTTP/1.1\r\n" + meant + "\r\n"), StartsWith("HTTP/1.1 405 "));
  // A browser asks by OPTIONS which headers a page may send across origins.
  EXPECT_THAT(answer_to("OPTIONS /control HTTP/1.1\r\nOrigin: http://evil.example\r\n\r\n"),
              StartsWith("HTTP/1.1 405 "));
}

TEST_F(HttpServerTest, ServesExactPathsOnly) {
  start();
  for (const char* path : {"/",
                           "/nothing",
                           "/open/",
                           "/open/../secret",
                           "/../../etc/passwd",
                           "/%2e%2e/%2e%2e/etc/passwd",
                           "//open",
                           "/open%00",
                           "/..%2fopen"}) {
    EXPECT_THAT(http_get(server_->port(), path), StartsWith("HTTP/1.1 404 ")) << path;
  }
}

TEST_F(HttpServerTest, RefusesInvalidRequests) {
  start();
  EXPECT_THAT(answer_to("POST /open HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(answer_to("DELETE /open HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(answer_to("POST /open HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\nx"),
              StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to("GET /open HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n"),
              StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to("\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(answer_to(std::string("\0\xff\xfe garbage\r\n\r\n", 15)),
              StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(answer_to("GET /open HTTP/9.9\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 ")) << "still alive";
}

TEST_F(HttpServerTest, ChangesSomethingByPostOnlyAndNotForPagesOfTheWeb) {
  start();
  EXPECT_THAT(answer_to("POST /change HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 202 "));
  EXPECT_THAT(answer_to("POST /change HTTP/1.1\r\nContent-Length: 0\r\n\r\n"),
              StartsWith("HTTP/1.1 202 "));
  const std::string get = answer_to("GET /change HTTP/1.1\r\n\r\n");
  EXPECT_THAT(get, StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(get, HasSubstr("Allow: POST\r\n"));
  EXPECT_THAT(answer_to("POST /change HTTP/1.1\r\nContent-Length: 1\r\n\r\nx"),
              StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to("POST /change HTTP/1.1\r\nOrigin: http://evil.example\r\n\r\n"),
              StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(answer_to("POST /change HTTP/1.1\r\nHost: evil.example\r\n\r\n"),
              StartsWith("HTTP/1.1 421 "));
}

TEST_F(HttpServerTest, RefusesAFloodOfHeaders) {
  start();
  EXPECT_THAT(answer_to("GET /open HTTP/1.1\r\nX: " + std::string(100'000, 'x') + "\r\n\r\n"),
              StartsWith("HTTP/1.1 431 "));
  std::string many = "GET /open HTTP/1.1\r\n";
  for (int i = 0; i < 10'000; ++i) {
    many += "X-" + std::to_string(i) + ": 1\r\n";
  }
  EXPECT_THAT(answer_to(many), StartsWith("HTTP/1.1 431 "));
}

TEST_F(HttpServerTest, SendsThePolicyWithEveryAnswer) {
  start();
  for (const std::string& request : {std::string("GET /open HTTP/1.1\r\n\r\n"),
                                     std::string("GET /none HTTP/1.1\r\n\r\n"),
                                     std::string("no request\r\n\r\n"),
                                     "GET /open HTTP/1.1\r\nX: " + std::string(100'000, 'x')}) {
    expect_policy(answer_to(request));
  }
}

TEST_F(HttpServerTest, AReportHasItsOwnStylesAndRunsNothing) {
  start();
  const std::string answer = http_get(server_->port(), "/report");
  EXPECT_THAT(answer,
              HasSubstr("\r\nContent-Security-Policy: default-src 'none'; style-src "
                        "'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors "
                        "'none'\r\n"));
  EXPECT_THAT(answer, Not(HasSubstr("script-src")));
  EXPECT_THAT(answer, HasSubstr("\r\nX-Content-Type-Options: nosniff\r\n"));
}

TEST_F(HttpServerTest, SlowClientsDelayNoOthers) {
  HttpServer::Options options;
  options.limits.time = std::chrono::hours(1);  // who waits for them waits for ever
  start(options);
  std::deque<HttpClient> slow;
  for (int i = 0; i < 20; ++i) {
    slow.emplace_back(server_->port());
    slow.back().send("GET /open HTTP/1.1\r\nX: ");
  }
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  // One that does not fetch its answer.
  HttpClient lazy(server_->port());
  lazy.send("GET /large HTTP/1.1\r\n\r\n");
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServerTest, SlowBytesDoNotExtendTheTimeLimit) {
  HttpServer::Options options;
  options.limits.time = std::chrono::milliseconds(700);
  start(options);
  std::deque<HttpClient> slow;
  slow.emplace_back(server_->port());
  slow.back().send("GET /open HTTP/1.1\r\nX: ");
  EXPECT_TRUE(eventually(kPatience, [&] { return !slow.front().send("x"); })) << "closed";
  for (const HttpClient& client : slow) {
    EXPECT_THAT(client.receive(), IsEmpty());
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return server_->counters().timed_out == 1; }));
}

TEST_F(HttpServerTest, ANewConnectionDisplacesTheOldest) {
  HttpServer::Options options;
  options.limits.connections = 4;
  start(options);
  std::deque<HttpClient> idle;
  for (int i = 0; i < 10; ++i) {
    idle.emplace_back(server_->port());
    ASSERT_TRUE(idle.back().connected());
  }
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  EXPECT_GE(server_->counters().displaced, 7U);
  idle.back().send("GET /open HTTP/1.1\r\n\r\n");
  EXPECT_THAT(idle.back().receive(), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServerTest, AsksForTheToken) {
  HttpServer::Options options;
  options.token = "0123456789abcdef";
  start(options);
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(http_get(server_->port(), "/secret"), StartsWith("HTTP/1.1 401 "));
  for (const char* wrong : {"",
                            "Bearer ",
                            "Bearer 0123456789abcde",
                            "Bearer 0123456789abcdeF",
                            "Bearer 0123456789abcdef0",
                            "Basic 0123456789abcdef"}) {
    const std::string answer =
        http_get(server_->port(), "/secret", std::string("Authorization: ") + wrong + "\r\n");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 401 ")) << wrong;
    EXPECT_THAT(answer, Not(HasSubstr("here")));
  }
  EXPECT_THAT(http_get(server_->port(), "/secret", "Authorization: Bearer 0123456789abcdef\r\n"),
              EndsWith("here\n"));
}

TEST_F(HttpServerTest, RefusesForeignHostNames) {
  start();
  const auto with_host = [&](const std::string& host) {
    return answer_to("GET /secret HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  };
  EXPECT_THAT(with_host("evil.example:8480"), StartsWith("HTTP/1.1 421 "));
  EXPECT_THAT(with_host("127.0.0.1.evil.example"), StartsWith("HTTP/1.1 421 "));
  EXPECT_THAT(with_host("127.0.0.1:8480"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(with_host("[::1]:8480"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServerTest, ATakenPortIsAnError) {
  start();
  HttpServer::Options options;
  options.port = server_->port();
  const auto second = HttpServer::open(options, {});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
  EXPECT_THAT(second.error().message, HasSubstr("another raylocd"));
}

}  // namespace
}  // namespace rayloc::http_server_test
