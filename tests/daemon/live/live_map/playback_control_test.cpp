// Tests the accepted requests to a playback of recordings, and the errors of the others.
#include "daemon/live/live_map/playback_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::playback_control_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

Playback::State state() {
  Playback::State state;
  state.begin = Timestamp(seconds(1000));
  state.end = Timestamp(seconds(1060));
  return state;
}

std::string refusal(const HttpParameters& parameters) {
  const auto change = playback_change(parameters, state());
  return change ? "accepted" : change.error().message;
}

TEST(PlaybackControl, AcceptsValidChanges) {
  const auto change =
      playback_change({{"state", "paused"}, {"speed", "0.5"}, {"position", "12.5"}}, state());
  ASSERT_TRUE(change) << change.error().message;
  EXPECT_EQ(change->play, false);
  EXPECT_EQ(change->speed, std::optional<double>(0.5));
  EXPECT_EQ(change->position, Timestamp(milliseconds(1'012'500)));

  const auto fast = playback_change({{"state", "playing"}, {"speed", "max"}}, state());
  ASSERT_TRUE(fast) << fast.error().message;
  EXPECT_EQ(fast->play, true);
  ASSERT_TRUE(fast->speed);
  EXPECT_FALSE(*fast->speed);
  EXPECT_FALSE(fast->position);
  for (const char* behind : {"60", "60.001", "1e300"}) {
    EXPECT_EQ(playback_change({{"position", behind}}, state())->position, state().end) << behind;
  }
}

TEST(PlaybackControl, ReportsAllowedValuesForInvalidOnes) {
  EXPECT_THAT(refusal({}), HasSubstr("?state=paused"));
  EXPECT_THAT(refusal({{"state", "stopped"}}), HasSubstr("'stopped'; write playing or paused"));
  for (const char* speed : {"0", "-1", "nan", "inf", "1e7", "1x", "", " 1", "0x1"}) {
    EXPECT_THAT(refusal({{"speed", speed}}), HasSubstr("write max, or a number from")) << speed;
  }
  for (const char* position : {"-1", "nan", "inf", "1e999", "", "1s"}) {
    EXPECT_THAT(refusal({{"position", position}}), HasSubstr("0 or more")) << position;
  }
  EXPECT_THAT(refusal({{"where", "1"}}), HasSubstr("'where' is not known"));
  EXPECT_THAT(refusal({{"speed", "1"}, {"speed", "2"}}), HasSubstr("more than once"));
}

}  // namespace
}  // namespace rayloc::playback_control_test
