// Streams of events over real sockets: viewers that come, stay, go, and take nothing.
#include <atomic>
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/http/http_server.h"
#include "tests/daemon/live/http/http_client.h"
#include "tests/support/eventually.h"

namespace rayloc::event_stream_test {
namespace {

using ::testing::HasSubstr;
using testing::http_get;
using testing::HttpClient;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::chrono::seconds kPatience{60};

// Gives each viewer the number that is set, once; `size` bytes of it.
class NumberFeed : public EventFeed {
 public:
  EventBatch take(EventCursor& cursor) override {
    if (cursor.begun && cursor.revision == number) {
      return {};
    }
    const std::string greeting = cursor.begun ? "" : "hello " + cursor.last_event_id + "\n";
    cursor.begun = true;
    const std::uint64_t missed = number - cursor.revision;
    cursor.revision = number;
    return {greeting + "number " + std::to_string(number) + std::string(size, 'x') + "\n\n",
            missed};
  }

  std::atomic<std::uint64_t> number = 1;
  std::atomic<std::size_t> size = 0;
};

class EventStream : public ::testing::Test {
 protected:
  void start(HttpServer::Options options = {}) {
    std::map<std::string, HttpRoute> routes;
    routes["/open"] = {[] { return HttpReply{200, "text/plain", "fine\n"}; }, true};
    routes["/events"] = {nullptr, false, feed_};
    auto opened = HttpServer::open(options, std::move(routes));
    ASSERT_TRUE(opened) << opened.error().message;
    server_ = std::move(*opened);
    server_->start();
  }
  HttpClient& view(const std::string& headers = "") {
    HttpClient& client = clients_.emplace_back(server_->port());
    client.send("GET /events HTTP/1.1\r\n" + headers + "\r\n");
    return client;
  }
  // Returns the text received until it contains `text`, or all of it if it never does.
  static std::string read_until(const HttpClient& client, const std::string& text) {
    std::string all;
    eventually(kPatience, [&] {
      all += client.receive(std::chrono::milliseconds(1));
      return all.find(text) != std::string::npos;
    });
    return all;
  }
  HttpCounters counters() const { return server_->counters(); }

  std::shared_ptr<NumberFeed> feed_ = std::make_shared<NumberFeed>();
  std::deque<HttpClient> clients_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(EventStream, SendsUpdatesAsTheyArrive) {
  start();
  const HttpClient& viewer = view();
  const std::string first = read_until(viewer, "number 1\n\n");
  EXPECT_THAT(first, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(first, HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_THAT(first, Not(HasSubstr("Content-Length")));
  EXPECT_THAT(first, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(first, HasSubstr("\r\n\r\nhello \nnumber 1\n\n"));
  feed_->number = 2;
  EXPECT_EQ(read_until(viewer, "number 2\n\n"), "number 2\n\n");
  EXPECT_TRUE(eventually(kPatience, [&] { return counters().events == 2; }));
  EXPECT_EQ(counters().viewers, 1U);
}

TEST_F(EventStream, PassesOnTheLastEventId) {
  start();
  EXPECT_THAT(read_until(view("Last-Event-ID: 7-12\r\n"), "number 1"), HasSubstr("hello 7-12\n"));
}

TEST_F(EventStream, AHeadRequestIsNoViewer) {
  start();
  const HttpClient client(server_->port());
  client.send("HEAD /events HTTP/1.1\r\n\r\n");
  EXPECT_THAT(client.receive(), HasSubstr("Content-Type: text/event-stream\r\n"));
  EXPECT_EQ(counters().viewers, 0U);
}

TEST_F(EventStream, AViewerAboveTheLimitGetsARetryTime) {
  HttpServer::Options options;
  options.limits.viewers = 2;
  start(options);
  read_until(view(), "number 1");
  read_until(view(), "number 1");
  const std::string refused = view().receive();
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 503 "));
  EXPECT_THAT(refused, HasSubstr("\r\nRetry-After: 5\r\n"));
  testing::expect_policy(refused);
  EXPECT_EQ(counters().viewers_refused, 1U);
  // One leaves, and its place is free.
  clients_.pop_front();
  EXPECT_TRUE(eventually(kPatience, [&] { return counters().viewers_left == 1; }));
  EXPECT_THAT(read_until(view(), "number 1"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(EventStream, OutlivesTheTimeOfARequestAndAFloodOfConnections) {
  HttpServer::Options options;
  options.limits.time = std::chrono::milliseconds(1);
  options.limits.connections = 4;
  start(options);
  const HttpClient& viewer = view();
  read_until(viewer, "number 1");
  std::deque<HttpClient> idle;
  for (int i = 0; i < 20; ++i) {
    idle.emplace_back(server_->port());
  }
  EXPECT_TRUE(
      eventually(kPatience, [&] { return counters().timed_out + counters().displaced == 20; }));
  feed_->number = 2;
  EXPECT_EQ(read_until(viewer, "number 2\n\n"), "number 2\n\n");
}

TEST_F(EventStream, AViewerThatTakesNothingIsClosedAndCostsOneBatch) {
  HttpServer::Options options;
  options.limits.event_patience = std::chrono::milliseconds(300);
  options.limits.event_interval = std::chrono::milliseconds(0);
  feed_->size = 32U << 20U;  // more than a kernel keeps for it
  start(options);
  const HttpClient& stuck = view();
  ASSERT_TRUE(eventually(kPatience, [&] { return counters().events == 1; }));
  for (std::uint64_t i = 2; i < 1000; ++i) {
    feed_->number = i;
  }
  EXPECT_TRUE(eventually(kPatience, [&] { return counters().viewers_stuck == 1; }));
  EXPECT_EQ(counters().events, 1U) << "nothing is made for who has not taken the last";
  feed_->size = 0;
  read_until(view(), "number 999");
  EXPECT_THAT(http_get(server_->port(), "/open"), StartsWith("HTTP/1.1 200 "));
  EXPECT_LT(stuck.receive().size(), std::size_t{32} << 20U);
}

TEST_F(EventStream, ASlowViewerGetsTheLatestAndTheRestIsCounted) {
  feed_->size = 16U << 20U;
  start();
  const HttpClient& slow = view();
  ASSERT_TRUE(eventually(kPatience, [&] { return counters().events == 1; }));
  feed_->number = 2;
  feed_->number = 500;
  feed_->size = 0;
  const std::string all = read_until(slow, "number 500\n\n");
  EXPECT_THAT(all.substr(all.size() - 20), HasSubstr("number 500\n\n"));
  EXPECT_EQ(all.find("number 2x"), std::string::npos);
  EXPECT_EQ(counters().messages_coalesced, 1U + 499U);
}

TEST_F(EventStream, ABrowserGivesTheTokenAsAPassword) {
  HttpServer::Options options;
  options.token = "0123456789abcdef";
  start(options);
  const std::string refused = http_get(server_->port(), "/events");
  EXPECT_THAT(refused, StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(refused, HasSubstr("\r\nWWW-Authenticate: Basic realm="));
  EXPECT_THAT(refused, HasSubstr("\r\nWWW-Authenticate: Bearer\r\n"));
  // rayloc:0123456789abcdeX
  EXPECT_THAT(view("Authorization: Basic cmF5bG9jOjAxMjM0NTY3ODlhYmNkZVg=\r\n").receive(),
              StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(
      read_until(view("Authorization: Basic cmF5bG9jOjAxMjM0NTY3ODlhYmNkZWY=\r\n"), "number 1"),
      StartsWith("HTTP/1.1 200 "));
}

}  // namespace
}  // namespace rayloc::event_stream_test
