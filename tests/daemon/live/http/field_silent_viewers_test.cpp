// Viewers that request events and never read do not keep other clients from their answers.
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/http/http_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/support/eventually.h"

namespace rayloc::field_silent_viewers_test {
namespace {

using testing::http_get;
using testing::HttpClient;
using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};

class TalkativeFeed : public EventFeed {
 public:
  EventBatch take(EventCursor& cursor) override {
    cursor.begun = true;
    return {std::string(10'000, 'x') + "\n\n", 0};
  }
};

std::unique_ptr<HttpServer> started(const HttpServer::Options& options) {
  std::map<std::string, HttpRoute> routes;
  routes["/open"] = {[] { return HttpReply{200, "text/plain", "fine\n"}; }, true};
  routes["/events"] = {nullptr, true, std::make_shared<TalkativeFeed>()};
  auto opened = HttpServer::open(options, std::move(routes));
  EXPECT_TRUE(opened) << opened.error().message;
  (*opened)->start();
  return std::move(*opened);
}

TEST(Field, HttpViewersThatNeverReadDisplaceNoNewConnection) {
  HttpServer::Options options;
  // The machine may be busy: the test examines only which connections are displaced.
  options.limits.time = test::patient(kPatience);
  const auto server = started(options);
  std::deque<HttpClient> silent;
  for (int round = 0; round < 3; ++round) {
    const HttpClient just_come(server->port());
    ASSERT_TRUE(just_come.connected());
    just_come.send("GET /open HTTP/1.1\r\n");
    for (std::size_t i = 0; i < options.limits.connections; ++i) {
      silent.emplace_back(server->port());
      silent.back().send("GET /events HTTP/1.1\r\n\r\n");
    }
    EXPECT_TRUE(just_come.send("\r\n"));
    EXPECT_THAT(just_come.receive(kPatience), StartsWith("HTTP/1.1 200 ")) << round;
    EXPECT_THAT(http_get(server->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return server->counters().displaced > 100; }));
  EXPECT_EQ(server->counters().viewers, options.limits.viewers);
}

TEST(Field, HttpSilentConnectionsYieldToNewOnes) {
  HttpServer::Options options;
  options.limits.connections = 8;
  options.limits.time = test::patient(kPatience);
  const auto server = started(options);
  std::deque<HttpClient> silent;
  for (std::size_t i = 0; i < 3 * options.limits.connections; ++i) {
    silent.emplace_back(server->port());
  }
  EXPECT_THAT(http_get(server->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  EXPECT_GE(server->counters().displaced, 2 * options.limits.connections);
}

}  // namespace
}  // namespace rayloc::field_silent_viewers_test
