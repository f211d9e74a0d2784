// Tests the lines and notes of `rayloc sub` for a sequence of messages.
#include "daemon/cli/feed/feed_follower.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

namespace rayloc::cli::feed_follower_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

PublishedMessage message(const std::string& topic, const std::string& text) {
  v1::Envelope envelope;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &envelope)) << text;
  return {topic, envelope.SerializeAsString()};
}

PublishedMessage location(int sequence, int epoch = 1) {
  return message("v1/location/office/track-4/",
                 "epoch: " + std::to_string(epoch) + " sequence: " + std::to_string(sequence) +
                     " location { kind: LOCATION_KIND_FILTERED mode: FIX_MODE_2D"
                     " target { track: 4 } position { x: 1 } }");
}

// A follower with everything that it writes.
struct Followed {
  explicit Followed(FeedRequest request)
      : feed(std::move(request),
             {[this](const std::string& line) -> Expected<void> {
                if (is_closed) {
                  return make_error(ErrorKind::kUnavailable, "closed");
                }
                lines.push_back(line);
                return {};
              },
              [this](const std::string& note) { notes.push_back(note); }}) {}

  std::vector<std::string> lines;
  std::vector<std::string> notes;
  bool is_closed = false;
  FeedFollower feed;
};

TEST(FeedFollower, SubscribesToTheTopicsOfItsFormat) {
  EXPECT_THAT(Followed({}).feed.prefixes(), ElementsAre("v1/"));
  EXPECT_THAT(Followed({.format = FeedFormat::kCsv}).feed.prefixes(), ElementsAre("v1/location/"));
  EXPECT_THAT(Followed({.topics = {"v1/zone/"}, .format = FeedFormat::kOmlox}).feed.prefixes(),
              ElementsAre("v1/zone/", "v1/heartbeat/"));
}

TEST(FeedFollower, EndsAtTheCountOfWrittenLines) {
  Followed followed({.topics = {"v1/location/"}, .count = 2});
  ASSERT_TRUE(followed.feed.begin());
  ASSERT_TRUE(followed.feed.take(location(1)));
  ASSERT_TRUE(followed.feed.take(message("v1/heartbeat/office/", "epoch: 1 heartbeat {}")));
  EXPECT_FALSE(followed.feed.is_done());
  ASSERT_TRUE(followed.feed.take(location(2)));
  EXPECT_TRUE(followed.feed.is_done());
  ASSERT_TRUE(followed.feed.take(location(3)));
  EXPECT_EQ(followed.lines.size(), 2U);
  EXPECT_THAT(followed.notes, IsEmpty());
}

TEST(FeedFollower, ReportsLossesRestartsAndForeignMessages) {
  Followed followed({});
  for (const auto& [sequence, epoch] : {std::pair(1, 1), std::pair(4, 1), std::pair(1, 2)}) {
    ASSERT_TRUE(followed.feed.take(location(sequence, epoch)));
  }
  ASSERT_TRUE(followed.feed.take({"v1/\x1b", "\xff"}));
  EXPECT_EQ(followed.lines.size(), 3U);
  EXPECT_THAT(followed.notes,
              ElementsAre("lost 2 messages of v1/location/office/track-4/",
                          "the daemon was restarted",
                          "a message of v1/? is no Envelope"));
}

TEST(FeedFollower, CountsMessagesWithoutAForm) {
  Followed followed({.topics = {"v1/"}, .format = FeedFormat::kCsv});
  ASSERT_TRUE(followed.feed.begin());
  ASSERT_EQ(followed.lines.size(), 1U) << "the header";
  ASSERT_TRUE(followed.feed.take(message("v1/heartbeat/office/", "epoch: 1 heartbeat {}")));
  ASSERT_TRUE(followed.feed.take(location(1)));
  EXPECT_EQ(followed.lines.size(), 2U);
  followed.feed.report_left_out();
  EXPECT_THAT(followed.notes, ElementsAre(HasSubstr("1 messages have no form in this format")));
}

TEST(FeedFollower, AClosedOutputIsAnError) {
  Followed followed({});
  followed.is_closed = true;
  EXPECT_FALSE(followed.feed.take(location(1)));
}

}  // namespace
}  // namespace rayloc::cli::feed_follower_test
