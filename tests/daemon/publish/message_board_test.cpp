#include "daemon/publish/message_board.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class MessageBoardTest : public ::testing::Test {
 protected:
  void locate(const std::string& target, v1::LocationKind kind, const std::string& bytes) {
    v1::Envelope envelope;
    envelope.mutable_location()->set_kind(kind);
    board_.put("v1/location/room/" + target + "/", envelope, bytes);
  }
  std::vector<std::string> after(std::uint64_t revision, std::size_t limit = 100) const {
    std::vector<std::string> texts;
    for (const MessageBoard::Message& message : board_.after(revision, limit)) {
      texts.push_back(*message.envelope);
    }
    return texts;
  }

  MessageBoard board_{40};
};

TEST_F(MessageBoardTest, KeepsTheLatestOfEachTargetAndKind) {
  locate("a", v1::LOCATION_KIND_SNAPSHOT, "a1");
  locate("a", v1::LOCATION_KIND_FILTERED, "a2");
  locate("b", v1::LOCATION_KIND_SNAPSHOT, "b3");
  locate("a", v1::LOCATION_KIND_SNAPSHOT, "a4");
  EXPECT_THAT(after(0), ElementsAre("a2", "b3", "a4"));
  EXPECT_THAT(after(2), ElementsAre("b3", "a4"));
  EXPECT_THAT(after(0, 2), ElementsAre("a2", "b3"));
  EXPECT_EQ(board_.after(0, 2).back().revision, 3U);
  EXPECT_THAT(after(4), IsEmpty());
  EXPECT_EQ(board_.revision(), 4U);
}

TEST_F(MessageBoardTest, KeepsTheLastEventsOfATopicOneByOne) {
  v1::Envelope envelope;
  envelope.mutable_track();
  for (std::uint64_t i = 1; i <= 35; ++i) {
    envelope.set_sequence(i);
    board_.put("v1/track/room/", envelope, "event " + std::to_string(i));
  }
  const std::vector<std::string> kept = after(0);
  ASSERT_EQ(kept.size(), 32U);
  EXPECT_EQ(kept.front(), "event 4");
  EXPECT_EQ(kept.back(), "event 35");
}

TEST_F(MessageBoardTest, ForgetsTheSubjectWrittenLongestAgo) {
  for (int i = 0; i < 41; ++i) {
    locate("t" + std::to_string(i), v1::LOCATION_KIND_SNAPSHOT, std::to_string(i));
  }
  EXPECT_EQ(after(0).size(), 40U);
  EXPECT_EQ(after(0).front(), "1");
  locate("t0", v1::LOCATION_KIND_SNAPSHOT, "again");
  EXPECT_EQ(after(0).front(), "2");
}

TEST_F(MessageBoardTest, LeavesChannelsOut) {
  v1::Envelope envelope;
  envelope.mutable_csi();
  board_.put("v1/csi/room/ap1/", envelope, "csi");
  EXPECT_THAT(after(0), IsEmpty());
}

}  // namespace
}  // namespace rayloc
