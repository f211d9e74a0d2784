// Tests the server behind other servers: forwarded paths, and the headers of browsers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/http/http_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/support/eventually.h"

namespace rayloc::field_front_test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::http_get;
using testing::HttpClient;
using ::testing::Not;
using ::testing::StartsWith;

// Sends one event, and nothing afterwards.
class QuietFeed : public EventFeed {
 public:
  EventBatch take(EventCursor& cursor) override {
    return {std::exchange(cursor.begun, true) ? "" : "data: hello\n\n", 0};
  }
};

class FrontedServer {
 public:
  explicit FrontedServer(HttpServer::Options options) {
    std::map<std::string, HttpRoute> routes;
    routes["/"] = {[] { return HttpReply{200, "text/html", "page"}; }};
    routes["/map/main.js"] = {[] { return HttpReply{200, "text/javascript", "script"}; }};
    routes["/events"] = {nullptr, false, std::make_shared<QuietFeed>()};
    routes["/control"] = {.handler = [] { return HttpReply{}; },
                          .control = [](const HttpParameters&) { return HttpReply{}; }};
    server_ = std::move(*HttpServer::open(options, std::move(routes)));
    server_->start();
  }
  explicit FrontedServer(const HttpFront& front) : FrontedServer(with(front)) {}

  std::string get(const std::string& path) const { return http_get(server_->port(), path); }
  std::string ask(const std::string& request) const {
    const HttpClient client(server_->port());
    client.send(request);
    return client.receive();
  }
  std::string control(const std::string& headers) const {
    return ask("POST /control HTTP/1.1\r\n" + std::string(kControlHeader) + ": 1\r\n" + headers +
               "\r\n");
  }
  std::uint16_t port() const { return server_->port(); }

 private:
  static HttpServer::Options with(const HttpFront& front) {
    HttpServer::Options options;
    options.front = front;
    return options;
  }
  std::unique_ptr<HttpServer> server_;
};

TEST(Field, HttpAnswersBelowAPathThatIsPassedOn) {
  const FrontedServer server(HttpFront{.base_path = "/home/rayloc/"});
  EXPECT_THAT(server.get("/home/rayloc/"), EndsWith("\r\n\r\npage"));
  EXPECT_THAT(server.get("/home/rayloc/map/main.js?1"), EndsWith("\r\n\r\nscript"));
  EXPECT_THAT(server.get("/map/main.js"), EndsWith("\r\n\r\nscript")) << "and without it";
  // Relative, as the addresses of the page are, so it is right behind any server.
  const std::string moved = server.get("/home/rayloc");
  EXPECT_THAT(moved, StartsWith("HTTP/1.1 308 "));
  EXPECT_THAT(moved, HasSubstr("\r\nLocation: rayloc/\r\n"));
  testing::expect_policy(moved);
  for (const char* path : {"/home", "/home/", "/home/raylocx/", "/home/rayloc//", "/rayloc/"}) {
    EXPECT_THAT(server.get(path), StartsWith("HTTP/1.1 404 ")) << path;
  }
  EXPECT_THAT(FrontedServer(HttpFront{}).get("/home/rayloc/"), StartsWith("HTTP/1.1 404 "));
}

TEST(Field, HttpEventsAreNeitherCachedNorCompressed) {
  HttpServer::Options options;
  options.limits.event_silence = std::chrono::milliseconds(50);
  const FrontedServer server(options);
  const HttpClient viewer(server.port());
  viewer.send("GET /events HTTP/1.0\r\nHost: 127.0.0.1:8480\r\nConnection: close\r\n\r\n");
  std::string all;
  // A server in between would close a silent stream: this one sends comments.
  EXPECT_TRUE(eventually(std::chrono::seconds(60), [&] {
    all += viewer.receive(std::chrono::milliseconds(1));
    return all.find("\r\n\r\ndata: hello\n\n:\n\n:\n\n") != std::string::npos;
  })) << all;
  EXPECT_THAT(all, HasSubstr("\r\nX-Accel-Buffering: no\r\n"));
  EXPECT_THAT(all, HasSubstr("\r\nCache-Control: no-store, no-transform\r\n"));
}

TEST(Field, HttpIsShownInFramesOfThePagesThatMay) {
  constexpr const char* kNoAncestors = "frame-ancestors 'none'\r\n";
  EXPECT_THAT(FrontedServer(HttpFront{}).get("/"), HasSubstr(kNoAncestors));
  const HttpFront card{.frame_ancestors = {"self", "http://homeassistant.local:8123"}};
  for (const char* path : {"/", "/none", "/control"}) {
    EXPECT_THAT(FrontedServer(card).get(path),
                HasSubstr("frame-ancestors 'self' http://homeassistant.local:8123\r\n"))
        << path;
  }
  EXPECT_THAT(FrontedServer(HttpFront{.frame_ancestors = {"*"}}).get("/"),
              HasSubstr("frame-ancestors *\r\n"));
  EXPECT_THAT(FrontedServer(HttpFront{.frame_ancestors = {"x\r\nSet-Cookie: y"}}).get("/"),
              HasSubstr(kNoAncestors));
}

TEST(Field, HttpAnswersToTheNamesThatAreListedAndToNoOther) {
  const FrontedServer server(
      HttpFront{.origins = {"https://Home.example", "http://nas:8480", "http://[fd00::1]"}});
  const auto with_host = [&](const std::string& host) {
    return server.ask("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
  };
  // A server before this one may leave the port out ("$host" of nginx).
  for (const char* host : {"home.example", "HOME.example:443", "nas:8480", "nas", "[fd00::1]"}) {
    EXPECT_THAT(with_host(host), StartsWith("HTTP/1.1 200 ")) << host;
  }
  for (const char* host :
       {"evil.example", "home.example.evil.example", "example", "home.example."}) {
    const std::string answer = with_host(host);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 421 ")) << host;
    EXPECT_THAT(answer, HasSubstr("[http] origins")) << "what to do";
  }
  // Headers that any client can write have no effect.
  EXPECT_THAT(
      server.ask("GET / HTTP/1.1\r\nHost: evil.example\r\nX-Forwarded-Host: home.example\r\n"
                 "Forwarded: host=home.example\r\n\r\n"),
      StartsWith("HTTP/1.1 421 "));
}

TEST(Field, HttpIsControlledThroughAnotherServerByItsOwnPagesAlone) {
  const FrontedServer server(HttpFront{.origins = {"https://home.example"}});
  const auto from = [](const std::string& origin) {
    return "Host: 127.0.0.1:8480\r\nOrigin: " + origin + "\r\n";
  };
  const std::string same = "Sec-Fetch-Site: same-origin\r\n";
  EXPECT_THAT(server.control(from("https://home.example")), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(server.control(from("https://home.example:443")), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(server.control(from("http://127.0.0.1:28481") + same), StartsWith("HTTP/1.1 200 "));
  for (const std::string& headers :
       {from("http://home.example"),
        from("https://home.example:8443"),
        from("https://home.example.evil.example"),
        from("http://127.0.0.1:28481"),
        from("null") + same,
        from("https://other.example") + "Sec-Fetch-Site: same-site\r\n",
        from("https://evil.example") + "Sec-Fetch-Site: cross-site\r\n",
        "Host: evil.example\r\nOrigin: http://evil.example\r\n" + same}) {
    const std::string answer = server.control(headers);
    EXPECT_THAT(answer, Not(StartsWith("HTTP/1.1 200 "))) << headers;
    EXPECT_THAT(answer, HasSubstr("[http] origins")) << headers;
  }
}

TEST(Field, HttpOriginsArePagesWithoutAPath) {
  EXPECT_EQ(parse_origin("https://Home.Example"), (WebOrigin{"https", "home.example", 443}));
  EXPECT_EQ(parse_origin("http://192.168.1.2:8123"), (WebOrigin{"http", "192.168.1.2", 8123}));
  EXPECT_EQ(parse_origin("http://[FD00::1]:80"), (WebOrigin{"http", "[fd00::1]", 80}));
  for (const char* text : {"",
                           "null",
                           "home.example",
                           "//home.example",
                           "ftp://home.example",
                           "https://",
                           "https://home.example/",
                           "https://home.example/rayloc",
                           "https://home.example:",
                           "https://home.example:0",
                           "https://home.example:65536",
                           "https://home.example:+1",
                           "https://me@home.example",
                           "https://home.example; script-src *",
                           "https://*.example",
                           "http://[::1",
                           "http://::1"}) {
    EXPECT_FALSE(parse_origin(text)) << text;
  }
  EXPECT_EQ(parse_base_path("/"), "");
  EXPECT_EQ(parse_base_path("/a/b-1._~/"), "/a/b-1._~");
  for (const char* text : {"", "rayloc", "//", "/a//b", "/a/../b", "/.", "/a b", "/%41", "/a?b"}) {
    EXPECT_FALSE(parse_base_path(text)) << text;
  }
}

}  // namespace
}  // namespace rayloc::field_front_test
