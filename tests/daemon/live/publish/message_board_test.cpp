#include "daemon/live/publish/message_board.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::message_board_test {
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

TEST_F(MessageBoardTest, KeepsTheLatestOfEachMethodThatIsCompared) {
  const auto compare = [&](const std::string& method, v1::LocationKind kind, const char* bytes) {
    v1::Envelope envelope;
    envelope.mutable_compared()->set_kind(kind);
    board_.put("v1/compared/room/" + method + "/a/", envelope, bytes);
  };
  locate("a", v1::LOCATION_KIND_SNAPSHOT, "a1");
  compare("x", v1::LOCATION_KIND_SNAPSHOT, "x2");
  compare("x", v1::LOCATION_KIND_FILTERED, "x3");
  compare("y", v1::LOCATION_KIND_SNAPSHOT, "y4");
  compare("x", v1::LOCATION_KIND_SNAPSHOT, "x5");
  EXPECT_THAT(after(0), ElementsAre("a1", "x3", "y4", "x5"));
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

// Tests where and how long targets were present, as readers of the board request it.
class PresenceTest : public ::testing::Test {
 protected:
  void put(std::uint64_t track,
           double at_s,
           double x,
           double y,
           v1::LocationKind kind = v1::LOCATION_KIND_FILTERED,
           v1::TargetKind target = v1::TARGET_KIND_DEVICE) {
    v1::Envelope envelope;
    *envelope.mutable_sent() = to_proto(Timestamp(from_seconds(at_s)));
    v1::Location& location = *envelope.mutable_location();
    location.set_kind(kind);
    location.mutable_target()->set_kind(target);
    location.mutable_target()->set_track(track);
    location.mutable_target()->set_mac("02:00:00:00:00:01");
    location.mutable_position()->set_x(x);
    location.mutable_position()->set_y(y);
    board_.put("v1/location/room/a/", envelope, "bytes");
  }
  // [s] in the cell that has its middle there.
  double seconds(double x, double y, double now_s) const {
    for (const Presence::Cell& cell : board_.presence(Timestamp(from_seconds(now_s))).cells) {
      if (std::abs(cell.x - x) < 1e-9 && std::abs(cell.y - y) < 1e-9) {
        return cell.seconds;
      }
    }
    return 0.0;
  }

  static constexpr double kHour = 3600.0;
  MessageBoard board_{40, from_seconds(24.0 * kHour)};
};

TEST_F(PresenceTest, SumsHowLongTracksWereInEachCell) {
  for (int i = 0; i <= 10; ++i) {
    put(1, 1000.0 + 0.5 * i, 0.1, -0.1);
    put(2, 1000.0 + 0.5 * i, 0.2, -0.2);
  }
  EXPECT_NEAR(seconds(0.125, -0.125, 1010.0), 10.0, 1e-6) << "both together";
  put(1, 1006.0, 0.3, -0.1);
  EXPECT_NEAR(seconds(0.375, -0.125, 1010.0), 1.0, 1e-6);
  put(1, 1010.0, 0.6, -0.1);
  EXPECT_EQ(seconds(0.625, -0.125, 1010.0), 0.0) << "it was away in between";
  put(1, 1010.5, 0.6, -0.1, v1::LOCATION_KIND_SNAPSHOT);
  EXPECT_EQ(seconds(0.625, -0.125, 1010.0), 0.0) << "snapshots of the same do not count";
}

TEST_F(PresenceTest, ADeviceAndAPersonOfOneNumberAreTwo) {
  for (int i = 0; i <= 10; ++i) {
    put(1, 1000.0 + i, 0.1, 0.1);
    put(1, 1000.5 + i, 5.1, 0.1, v1::LOCATION_KIND_FILTERED, v1::TARGET_KIND_PERSON);
  }
  EXPECT_NEAR(seconds(0.125, 0.125, 1020.0), 10.0, 1e-6);
  EXPECT_NEAR(seconds(5.125, 0.125, 1020.0), 10.0, 1e-6);
}

TEST_F(PresenceTest, IsForgottenSlotBySlot) {
  for (const double hour : {0.5, 10.5}) {
    put(1, hour * kHour, 0.1, 0.1);
    put(1, hour * kHour + 1.0, 0.1, 0.1);
  }
  EXPECT_NEAR(seconds(0.125, 0.125, 11.0 * kHour), 2.0, 1e-6);
  EXPECT_NEAR(seconds(0.125, 0.125, 24.5 * kHour), 1.0, 1e-6);
  EXPECT_EQ(seconds(0.125, 0.125, 40.0 * kHour), 0.0);
}

TEST_F(PresenceTest, TakesBoundedMemory) {
  const int many = static_cast<int>(Presence::kMaxCells) + 100;
  for (int i = 0; i < many; ++i) {
    put(1, 1000.0 + i, 0.5 * i, 0.0);
  }
  const MessageBoard::PresenceNow now = board_.presence(Timestamp(from_seconds(1000.0 + many)));
  EXPECT_EQ(now.cells.size(), Presence::kMaxCells);
  EXPECT_EQ(now.left_out, 99U) << "the first has no time before it";
  put(1, 2e9, 1e300, std::nan(""));
  put(1, 2e9 + 1.0, 1e300, std::nan(""));
  EXPECT_TRUE(board_.presence(Timestamp(from_seconds(2e9 + 1.0))).cells.empty()) << "no place";
}

}  // namespace
}  // namespace rayloc::message_board_test
