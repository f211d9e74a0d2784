// Late subscribers under load, and requests that are none.
#include <atomic>
#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <zmq.hpp>

#include "daemon/live/publish/late_subscriber.h"
#include "daemon/live/publish/publisher.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/messages/last_messages.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/support/eventually.h"

namespace rayloc::snapshot_test {
namespace {

using namespace std::chrono_literals;

constexpr int kTargets = 5;
constexpr auto kPatience = 30s;

// A publisher of locations of five targets, one each 200 us at most, and of heartbeats.
class BusyPublisher {
 public:
  // At the endpoints of an earlier instance, and with another epoch, if stated.
  explicit BusyPublisher(const std::string& endpoint = "tcp://127.0.0.1:*",
                         const std::string& snapshot = "tcp://127.0.0.1:*",
                         std::uint64_t epoch = 77)
      : last_(std::make_shared<LastMessages>(4096)) {
    PublisherOptions options;
    options.endpoint = endpoint;
    options.site = "office";
    options.epoch = epoch;
    options.high_water_mark = 100'000;
    options.last = last_;
    publisher_.emplace(std::move(*Publisher::bind(options)));
    endpoint_ = publisher_->endpoint();
    snapshots_ = std::move(*SnapshotServer::open({snapshot, -1, epoch, last_}));
    thread_ = std::thread([this] { run(); });
  }
  ~BusyPublisher() {
    stopping_ = true;
    thread_.join();
  }
  const std::string& endpoint() const { return endpoint_; }
  const SnapshotServer& snapshots() const { return *snapshots_; }

 private:
  void run() {
    const Timestamp now{1718000000s};
    for (int i = 0; !stopping_; ++i) {
      v1::Location location;
      location.mutable_target()->set_kind(v1::TARGET_KIND_DEVICE);
      location.mutable_target()->set_mac("02:00:00:00:00:0" + std::to_string(i % kTargets));
      publisher_->publish(location, now);
      if (i % 50 == 0) {
        publisher_->publish(v1::Heartbeat(), now);
      }
      std::this_thread::sleep_for(200us);
    }
  }

  std::shared_ptr<LastMessages> last_;
  std::optional<Publisher> publisher_;
  std::string endpoint_;
  std::unique_ptr<SnapshotServer> snapshots_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

TEST(Snapshot, WithStreamGivesEverySequenceOnce) {
  const BusyPublisher publisher;
  constexpr int kJoins = 50;
  for (int join = 0; join < kJoins; ++join) {
    auto subscriber = LateSubscriber::join(publisher.endpoint(),
                                           publisher.snapshots().endpoint(),
                                           {"v1/location/"},
                                           test::patient(kPatience));
    ASSERT_TRUE(subscriber) << subscriber.error().message;
    std::map<std::string, std::uint64_t> last;
    for (int i = 0; i < 20 * kTargets; ++i) {
      const auto message = subscriber->receive(test::patient(kPatience));
      ASSERT_TRUE(message);
      v1::Envelope envelope;
      ASSERT_TRUE(envelope.ParseFromString(message->payload));
      ASSERT_TRUE(envelope.has_location()) << "nothing else was asked for";
      const auto [known, first] = last.emplace(message->topic, envelope.sequence());
      if (!first) {
        ASSERT_EQ(envelope.sequence(), known->second + 1) << message->topic << ", join " << join;
        known->second = envelope.sequence();
      }
    }
    EXPECT_LE(last.size(), std::size_t{kTargets});
  }
  // Counted once it is sent, which the client may notice first.
  EXPECT_TRUE(eventually(kPatience, [&] {
    return publisher.snapshots().counters().answered == std::uint64_t{kJoins};
  }));
}

TEST(Snapshot, IsAskedForAgainAfterARestartAndForgottenWhenItHasPassed) {
  std::optional<BusyPublisher> publisher(std::in_place);
  const std::string endpoint = publisher->endpoint();
  const std::string snapshot = publisher->snapshots().endpoint();
  auto subscriber =
      LateSubscriber::join(endpoint, snapshot, {"v1/location/"}, test::patient(kPatience));
  ASSERT_TRUE(subscriber) << subscriber.error().message;
  for (const std::uint64_t epoch : {77U, 78U}) {
    std::map<std::string, std::uint64_t> last;
    bool has_snapshot = false;
    bool forgotten = false;
    ASSERT_TRUE(eventually(
        kPatience,
        [&] {
          const auto message = subscriber->receive(test::patient(kPatience));
          v1::Envelope envelope;
          if (!message || !envelope.ParseFromString(message->payload) ||
              envelope.epoch() != epoch) {
            return false;  // of the start before
          }
          has_snapshot = has_snapshot || message->from_snapshot;
          forgotten = forgotten || (!message->from_snapshot && subscriber->remembered() == 0);
          const auto [known, first] = last.emplace(message->topic, envelope.sequence());
          EXPECT_TRUE(first || envelope.sequence() == known->second + 1) << message->topic;
          known->second = envelope.sequence();
          return has_snapshot && forgotten && last.size() == kTargets;
        }))
        << epoch << (has_snapshot ? " snapshot" : "") << (forgotten ? " forgotten" : "");
    if (epoch == 77U) {
      publisher.reset();
      publisher.emplace(endpoint, snapshot, 78);
    }
  }
}

TEST(Snapshot, DropsAndCountsInvalidRequests) {
  const BusyPublisher publisher;
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  socket.connect(publisher.snapshots().endpoint());
  socket.send(zmq::message_t(std::string("\xff\xff\xff no protobuf")), zmq::send_flags::none);
  for (int i = 0; i < 4; ++i) {
    socket.send(zmq::message_t(std::string("x")),
                i < 3 ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
  EXPECT_TRUE(
      eventually(kPatience, [&] { return publisher.snapshots().counters().malformed == 2; }));
  // A REQ socket is understood, and nothing is a request as well: no prefix, no topic.
  zmq::socket_t request(context, zmq::socket_type::req);
  request.set(zmq::sockopt::linger, 0);
  request.connect(publisher.snapshots().endpoint());
  request.send(zmq::message_t(), zmq::send_flags::none);
  zmq::message_t reply;
  EXPECT_TRUE(request.recv(reply));
  EXPECT_TRUE(
      eventually(kPatience, [&] { return publisher.snapshots().counters().answered == 1; }));
  EXPECT_FALSE(socket.recv(reply, zmq::recv_flags::dontwait));
}

TEST(Snapshot, ATooLongRequestEndsOnlyItsConnection) {
  const BusyPublisher publisher;
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.set(zmq::sockopt::linger, 0);
  socket.connect(publisher.snapshots().endpoint());
  socket.send(zmq::message_t(std::string(200'000, 'x')), zmq::send_flags::none);
  const auto subscriber = LateSubscriber::join(
      publisher.endpoint(), publisher.snapshots().endpoint(), {"v1/"}, test::patient(kPatience));
  EXPECT_TRUE(subscriber) << subscriber.error().message;
}

TEST(LastMessages, ForgetsTheTopicThatWasSilentLongest) {
  LastMessages last(2);
  last.put("a/", "1");
  last.put("b/", "1");
  last.put("a/", "2");
  last.put("c/", "1");
  const std::vector<std::pair<std::string, std::string>> all = last.matching({""});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0], (std::pair<std::string, std::string>("a/", "2")));
  EXPECT_EQ(all[1].first, "c/");
  EXPECT_TRUE(last.matching({}).empty());
  EXPECT_EQ(last.matching({"c", "x"}).size(), 1U);
}

}  // namespace
}  // namespace rayloc::snapshot_test
