#include "daemon/messages/gap_detector.h"

#include <gtest/gtest.h>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc::gap_detector_test {
namespace {

v1::Envelope numbered(std::uint64_t epoch, std::uint64_t sequence) {
  v1::Envelope envelope;
  envelope.set_epoch(epoch);
  envelope.set_sequence(sequence);
  return envelope;
}

TEST(GapDetector, CountsSkippedSequenceNumbers) {
  GapDetector detector;
  EXPECT_TRUE(detector.add("a/", numbered(1, 40)).empty());  // a late subscriber
  EXPECT_TRUE(detector.add("b/", numbered(1, 7)).empty());
  EXPECT_TRUE(detector.add("a/", numbered(1, 41)).empty());
  const auto gaps = detector.add("a/", numbered(1, 45));
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].topic, "a/");
  EXPECT_EQ(gaps[0].lost, 3U);
  EXPECT_EQ(detector.lost(), 3U);
}

TEST(GapDetector, ARestartIsNoGap) {
  GapDetector detector;
  detector.add("a/", numbered(1, 40));
  EXPECT_TRUE(detector.add("a/", numbered(2, 90)).empty());
  EXPECT_TRUE(detector.add("a/", numbered(2, 91)).empty());
  EXPECT_EQ(detector.restarts(), 1U);
  EXPECT_EQ(detector.lost(), 0U);
}

TEST(GapDetector, ATopicThatBeginsAnewIsNoGap) {
  GapDetector detector;
  detector.add("a/", numbered(1, 40));
  EXPECT_TRUE(detector.add("a/", numbered(1, 1)).empty());
  EXPECT_EQ(detector.add("a/", numbered(1, 3)).size(), 1U);
}

TEST(GapDetector, HeartbeatsShowLossOnSilentTopics) {
  GapDetector detector;
  detector.add("v1/location/s/a/", numbered(1, 40));
  v1::Envelope heartbeat = numbered(1, 5);
  auto& topic_class = *heartbeat.mutable_heartbeat()->add_topic_classes();
  const auto add_last = [&](const char* topic, std::uint64_t sequence) {
    auto& last = *topic_class.add_last_sequences();
    last.set_topic(topic);
    last.set_sequence(sequence);
  };
  add_last("v1/location/s/a/", 42);
  add_last("v1/location/s/not-subscribed/", 900);
  add_last("v1/heartbeat/s/", 4);
  const auto gaps = detector.add("v1/heartbeat/s/", heartbeat);
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].lost, 2U);
  // Reported once.
  EXPECT_TRUE(detector.add("v1/location/s/a/", numbered(1, 43)).empty());
}

TEST(GapDetector, AGoodbyeShowsLossOnSilentTopics) {
  GapDetector detector;
  detector.add("v1/location/s/a/", numbered(1, 40));
  v1::Envelope goodbye = numbered(1, 6);
  auto& last = *goodbye.mutable_goodbye()->add_topic_classes()->add_last_sequences();
  last.set_topic("v1/location/s/a/");
  last.set_sequence(43);
  const auto gaps = detector.add("v1/heartbeat/s/", goodbye);
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].lost, 3U);
}

TEST(GapDetector, ForgetsTheLeastRecentTopic) {
  GapDetector detector(2);
  detector.add("a/", numbered(1, 1));
  detector.add("b/", numbered(1, 1));
  detector.add("a/", numbered(1, 2));
  detector.add("c/", numbered(1, 1));                        // b is forgotten
  EXPECT_EQ(detector.add("a/", numbered(1, 4)).size(), 1U);  // a is known
  EXPECT_TRUE(detector.add("b/", numbered(1, 9)).empty());   // b is new, c is forgotten
  EXPECT_EQ(detector.add("b/", numbered(1, 11)).size(), 1U);
  EXPECT_TRUE(detector.add("c/", numbered(1, 50)).empty());
  EXPECT_EQ(detector.lost(), 2U);
}

}  // namespace
}  // namespace rayloc::gap_detector_test
