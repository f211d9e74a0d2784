// Real sockets: tcp over loopback and ipc.
#include "daemon/live/publish/publisher.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>

#include "daemon/live/publish/subscriber.h"
#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"
#include "tests/support/eventually.h"

namespace rayloc::publisher_test {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kNow{1718000000s + 123456789ns};
// A bound on waiting for what must come; nothing is measured by it.
constexpr auto kPatience = 30s;

PublisherOptions on_loopback() {
  PublisherOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.site = "office";
  options.epoch = 77;
  return options;
}

std::string temporary_ipc(const std::string& name) {
  return "ipc://" +
         (std::filesystem::temp_directory_path() / (name + "." + std::to_string(::getpid())))
             .string();
}

v1::Location location_of(const std::string& mac, double x = 1.0) {
  v1::Location location;
  location.mutable_target()->set_kind(v1::TARGET_KIND_DEVICE);
  location.mutable_target()->set_mac(mac);
  location.mutable_position()->set_x(x);
  return location;
}

// Subscribed for certain: waits until the publisher has seen `subscriptions`.
void wait_for_subscriptions(Publisher& publisher, std::uint64_t subscriptions) {
  ASSERT_TRUE(
      eventually(kPatience, [&] { return publisher.counters().subscriptions == subscriptions; }));
}

v1::Envelope receive(Subscriber& subscriber, std::string* topic = nullptr) {
  const auto message = subscriber.receive(test::patient(kPatience));
  v1::Envelope envelope;
  EXPECT_TRUE(message && envelope.ParseFromString(message->payload));
  if (message && topic != nullptr) {
    *topic = message->topic;
  }
  return envelope;
}

class PublisherOver : public ::testing::TestWithParam<const char*> {};

TEST_P(PublisherOver, SendsTopicAndEnvelope) {
  PublisherOptions options = on_loopback();
  if (GetParam() == std::string("ipc")) {
    options.endpoint = temporary_ipc("rayloc-publisher-test");
  }
  auto publisher = Publisher::bind(options);
  ASSERT_TRUE(publisher) << publisher.error().message;
  auto subscriber = Subscriber::connect(publisher->endpoint(), {"v1/"});
  ASSERT_TRUE(subscriber) << subscriber.error().message;
  wait_for_subscriptions(*publisher, 1);

  publisher->publish(location_of("02:52:4c:00:00:01", 2.5), kNow, 3);
  std::string topic;
  const v1::Envelope envelope = receive(*subscriber, &topic);
  EXPECT_EQ(topic, "v1/location/office/02:52:4c:00:00:01/");
  EXPECT_EQ(envelope.epoch(), 77U);
  EXPECT_EQ(envelope.sequence(), 1U);
  EXPECT_EQ(envelope.coalesced(), 3U);
  EXPECT_EQ(from_proto(envelope.sent()), kNow);
  EXPECT_EQ(envelope.location().position().x(), 2.5);
}

INSTANTIATE_TEST_SUITE_P(Transport, PublisherOver, ::testing::Values("tcp", "ipc"));

TEST(Publisher, NumbersEachTopicFromOne) {
  auto publisher = Publisher::bind(on_loopback());
  ASSERT_TRUE(publisher) << publisher.error().message;
  // Published before any subscription, and counted: a later subscriber detects the missed message.
  publisher->publish(location_of("a"), kNow);
  auto subscriber = Subscriber::connect(publisher->endpoint(), {"v1/"});
  wait_for_subscriptions(*publisher, 1);
  for (const char* mac : {"a", "b", "a", "b", "b"}) {
    publisher->publish(location_of(mac), kNow);
  }
  v1::TrackEvent event;
  publisher->publish(event, kNow);
  std::vector<std::pair<std::string, std::uint64_t>> seen;
  for (int i = 0; i < 6; ++i) {
    std::string topic;
    const v1::Envelope envelope = receive(*subscriber, &topic);
    seen.emplace_back(topic, envelope.sequence());
  }
  const std::vector<std::pair<std::string, std::uint64_t>> expected{{"v1/location/office/a/", 2},
                                                                    {"v1/location/office/b/", 1},
                                                                    {"v1/location/office/a/", 3},
                                                                    {"v1/location/office/b/", 2},
                                                                    {"v1/location/office/b/", 3},
                                                                    {"v1/track/office/", 1}};
  EXPECT_EQ(seen, expected);
}

TEST(Publisher, ComparedMethodsHaveTopicsOutsideOfLocationSubscriptions) {
  auto publisher = Publisher::bind(on_loopback());
  auto locations = Subscriber::connect(publisher->endpoint(), {"v1/location/"});
  auto all = Subscriber::connect(publisher->endpoint(), {"v1/"});
  wait_for_subscriptions(*publisher, 2);
  v1::Location compared = location_of("a", 1.5);
  compared.mutable_quality()->set_method("spotfi");
  publisher->publish_compared(compared, kNow, 2);
  publisher->publish(location_of("a", 2.5), kNow);
  std::string topic;
  const v1::Envelope first = receive(*all, &topic);
  EXPECT_EQ(topic, "v1/compared/office/spotfi/a/");
  EXPECT_EQ(first.body_case(), v1::Envelope::kCompared);
  EXPECT_EQ(first.compared().position().x(), 1.5);
  EXPECT_EQ(first.coalesced(), 2U);
  const v1::Envelope second = receive(*locations, &topic);
  EXPECT_EQ(topic, "v1/location/office/a/");
  EXPECT_EQ(second.location().position().x(), 2.5);
}

TEST(Publisher, MatchesWholeComponentsOnly) {
  auto publisher = Publisher::bind(on_loopback());
  auto subscriber = Subscriber::connect(publisher->endpoint(), {"v1/source/office/ap1/"});
  wait_for_subscriptions(*publisher, 1);
  v1::SourceState state;
  for (const char* id : {"ap10", "ap1/x", "ap1"}) {
    state.set_access_point(id);
    publisher->publish(state, kNow);
  }
  EXPECT_EQ(receive(*subscriber).source().access_point(), "ap1");
}

TEST(Publisher, HeartbeatContainsTheLastSequenceOfRecentTopics) {
  auto publisher = Publisher::bind(on_loopback());
  auto subscriber = Subscriber::connect(publisher->endpoint(), {"v1/heartbeat/"});
  wait_for_subscriptions(*publisher, 1);
  publisher->publish(location_of("a"), kNow);
  publisher->publish(location_of("a"), kNow);
  publisher->publish(location_of("b"), kNow);
  v1::Heartbeat heartbeat;
  heartbeat.set_software_version("1.2.3");
  publisher->publish(heartbeat, kNow);
  publisher->publish(location_of("b"), kNow);
  publisher->publish(heartbeat, kNow);

  const v1::Heartbeat first = receive(*subscriber).heartbeat();
  EXPECT_EQ(first.epoch(), 77U);
  EXPECT_EQ(first.software_version(), "1.2.3");
  EXPECT_EQ(first.message_version(), "v1");
  EXPECT_EQ(first.publisher().published(), 3U);
  EXPECT_EQ(first.publisher().subscriptions(), 1U);
  ASSERT_EQ(first.topic_classes_size(), 1);
  EXPECT_EQ(first.topic_classes(0).prefix(), "v1/location/office/");
  EXPECT_EQ(first.topic_classes(0).published(), 3U);
  ASSERT_EQ(first.topic_classes(0).last_sequences_size(), 2);
  EXPECT_EQ(first.topic_classes(0).last_sequences(0).topic(), "v1/location/office/a/");
  EXPECT_EQ(first.topic_classes(0).last_sequences(0).sequence(), 2U);

  const v1::Heartbeat second = receive(*subscriber).heartbeat();
  ASSERT_EQ(second.topic_classes_size(), 2);
  EXPECT_EQ(second.topic_classes(0).prefix(), "v1/heartbeat/office/");
  ASSERT_EQ(second.topic_classes(1).last_sequences_size(), 1);
  EXPECT_EQ(second.topic_classes(1).last_sequences(0).topic(), "v1/location/office/b/");
  EXPECT_EQ(second.topic_classes(1).last_sequences(0).sequence(), 2U);
}

TEST(Publisher, GoodbyeReachesTheSubscriberAfterThePublisherIsGone) {
  auto publisher = Publisher::bind(on_loopback());
  auto subscriber = Subscriber::connect(publisher->endpoint(), {"v1/"});
  wait_for_subscriptions(*publisher, 1);
  {
    Publisher stopping = std::move(*publisher);
    stopping.publish(location_of("a"), kNow);
    v1::Goodbye goodbye;
    goodbye.set_reason("SIGTERM");
    stopping.publish(goodbye, kNow);
  }
  EXPECT_TRUE(receive(*subscriber).has_location());
  const v1::Envelope envelope = receive(*subscriber);
  EXPECT_EQ(envelope.goodbye().reason(), "SIGTERM");
  ASSERT_EQ(envelope.goodbye().topic_classes_size(), 1);
  EXPECT_EQ(envelope.goodbye().topic_classes(0).published(), 1U);
}

TEST(Publisher, CountsSubscriptionsThatEnd) {
  auto publisher = Publisher::bind(on_loopback());
  {
    auto one = Subscriber::connect(publisher->endpoint(), {"v1/location/", "v1/track/"});
    auto other = Subscriber::connect(publisher->endpoint(), {"v1/location/"});
    wait_for_subscriptions(*publisher, 3);
  }
  wait_for_subscriptions(*publisher, 0);
}

TEST(Publisher, ReportsAnEndpointInUse) {
  for (const std::string& endpoint :
       {std::string("tcp://127.0.0.1:*"), temporary_ipc("rayloc-in-use-test")}) {
    PublisherOptions options = on_loopback();
    options.endpoint = endpoint;
    auto first = Publisher::bind(options);
    ASSERT_TRUE(first) << first.error().message;
    options.endpoint = first->endpoint();
    const auto second = Publisher::bind(options);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
    EXPECT_EQ(second.error().message,
              "cannot bind " + first->endpoint() +
                  ": Address already in use; is another raylocd running? Choose another endpoint "
                  "or stop it");
  }
}

TEST(Publisher, TakesOverTheSocketFileOfADeadDaemon) {
  PublisherOptions options = on_loopback();
  options.endpoint = temporary_ipc("rayloc-stale-test");
  const std::string path = options.endpoint.substr(6);
  {
    auto first = Publisher::bind(options);
    ASSERT_TRUE(first);
    std::filesystem::create_hard_link(path, path + ".kept");
  }
  std::filesystem::rename(path + ".kept", path);  // as SIGKILL leaves it
  const auto second = Publisher::bind(options);
  EXPECT_TRUE(second) << second.error().message;
}

TEST(Publisher, RefusesEndpointsThatItCannotUse) {
  for (const char* endpoint : {"",
                               "127.0.0.1:5560",
                               "ws://127.0.0.1:5560",
                               "tcp://127.0.0.1",
                               "tcp://:5560",
                               "tcp://127.0.0.1:",
                               "tcp://127.0.0.1:port",
                               "tcp://lo:5560",
                               "tcp://raylocd.example.org:5560",
                               "ipc://",
                               "inproc://x"}) {
    PublisherOptions options = on_loopback();
    options.endpoint = endpoint;
    const auto publisher = Publisher::bind(options);
    ASSERT_FALSE(publisher) << endpoint;
    EXPECT_EQ(publisher.error().kind, ErrorKind::kConfiguration) << endpoint;
    EXPECT_NE(publisher.error().message.find("tcp://ADDRESS:PORT"), std::string::npos)
        << publisher.error().message;
  }
  PublisherOptions nameless = on_loopback();
  nameless.site.clear();
  EXPECT_FALSE(Publisher::bind(nameless));
}

// With XPUB_NODROP alone the healthy subscriber gets some hundreds.
TEST(Publisher, AStuckSubscriberLosesAlone) {
  constexpr std::uint64_t kMessages = 20'000;
  constexpr std::uint64_t kAhead = 200;  // below the high-water mark: the healthy one keeps up
  PublisherOptions options = on_loopback();
  options.high_water_mark = 1000;
  auto publisher = Publisher::bind(options);
  ASSERT_TRUE(publisher);
  auto stuck = Subscriber::connect(publisher->endpoint(), {"v1/"}, 10);
  auto healthy = Subscriber::connect(publisher->endpoint(), {"v1/"});
  wait_for_subscriptions(*publisher, 2);

  v1::Location location = location_of("a");
  location.mutable_quality()->add_warnings(std::string(2000, 'w'));  // fills the kernel's buffers
  std::atomic<std::uint64_t> received{0};
  std::atomic<bool> in_order{true};
  std::thread reader([&] {
    for (std::uint64_t expected = 1; expected <= kMessages; ++expected) {
      if (receive(*healthy).sequence() != expected) {
        in_order = false;
        received = kMessages;
        return;
      }
      received = expected;
    }
  });
  for (std::uint64_t i = 0; i < kMessages; ++i) {
    while (received + kAhead < i) {
      std::this_thread::yield();
    }
    publisher->publish(location, kNow);
  }
  reader.join();
  EXPECT_TRUE(in_order);
  EXPECT_EQ(received, kMessages);
  EXPECT_GE(publisher->counters().slow_episodes, 1U);

  // The stuck one reads on: from 1 without a gap until its queue was full, then it sees the loss.
  std::uint64_t previous = 0;
  std::uint64_t lost = 0;
  std::uint64_t got = 0;
  while (previous < kMessages + 1) {
    publisher->publish(location, kNow);  // wakes a pipe that was left out
    const auto message = stuck->receive(1s);
    if (!message) {
      continue;
    }
    v1::Envelope envelope;
    ASSERT_TRUE(envelope.ParseFromString(message->payload));
    lost += envelope.sequence() - previous - 1;
    previous = envelope.sequence();
    ++got;
  }
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(lost + got, previous);
}

TEST(Publisher, EpochsDifferFromStartToStart) {
  EXPECT_NE(random_epoch(), random_epoch());
  EXPECT_NE(random_epoch(), 0U);
}

}  // namespace
}  // namespace rayloc::publisher_test
