// Recordings whose time stamps do not advance.
#include <chrono>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/pipeline/watch/stamp_check.h"

namespace rayloc::field_stamp_check_test {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Timestamp kStart = Timestamp(seconds(1'718'000'000)) + microseconds(959'529);

// A frame every `period`, stamped by `stamp` of its time.
template <typename Stamp>
std::vector<CsiFrame> walk(int frames, Duration period, Stamp stamp) {
  std::vector<CsiFrame> all;
  for (int i = 0; i < frames; ++i) {
    CsiFrame& frame = all.emplace_back();
    frame.time = frame.time_last = stamp(kStart + i * period);
    frame.transmitter.octets = {2, 0, 0, 0, 0, 1};
  }
  return all;
}

std::string text_of(const std::vector<CsiFrame>& frames) {
  StampTally tally;
  for (const CsiFrame& frame : frames) {
    const std::vector<Datagram> records(3, Datagram{frame.time, {}, {}});
    tally.add(records);
    tally.add(std::span(&frame, 1));
  }
  return tally.text();
}

TEST(Field, StampsThatDoNotAdvanceAreNamed) {
  for (const Timestamp one : {kStart, Timestamp()}) {
    const auto frames = walk(31, milliseconds(100), [&](Timestamp) { return one; });
    const auto stamp = stuck_stamp(frames);
    ASSERT_TRUE(stamp);
    EXPECT_TRUE(stamp->is_stuck());
    EXPECT_EQ(stamp->frames, 31U);
    EXPECT_THAT(text_of(frames), AllOf(HasSubstr("93 of 93 records"), HasSubstr("do not advance")));
  }
}

TEST(Field, StampsOfWholeSecondsAreNamed) {
  const auto frames = walk(90, milliseconds(100), [](Timestamp time) {
    return Timestamp(std::chrono::floor<seconds>(time));
  });
  const auto stamp = stuck_stamp(std::span(frames).subspan(11, 5));
  ASSERT_TRUE(stamp);
  EXPECT_FALSE(stamp->is_stuck());
  EXPECT_THAT(text_of(frames), AllOf(HasSubstr("30 of 270 records"), HasSubstr("whole seconds")));
}

TEST(Field, ClockThatStopsWithinARecordingIsNamed) {
  auto frames = walk(
      90, milliseconds(100), [](Timestamp time) { return std::min(time, kStart + seconds(6)); });
  EXPECT_THAT(text_of(frames), HasSubstr("do not advance"));
  EXPECT_FALSE(stuck_stamp(std::span(frames).subspan(0, 20)));
}

TEST(Field, HealthyStampsRaiseNoAlarm) {
  const auto as_is = [](Timestamp time) { return time; };
  EXPECT_THAT(text_of(walk(500, milliseconds(3), as_is)), IsEmpty());
  // A recorder that reads several frames at once stamps them alike.
  const auto eight_at_once = [](Timestamp time) {
    const Duration since = (time - kStart) / milliseconds(400) * milliseconds(400);
    return kStart + since;
  };
  const auto together = walk(400, milliseconds(50), eight_at_once);
  EXPECT_THAT(text_of(together), IsEmpty());
  EXPECT_FALSE(stuck_stamp(std::span(together).subspan(0, 8)));
  // Milliseconds are fine enough, and by chance some are of whole seconds.
  const auto in_ms = [](Timestamp time) {
    return Timestamp(std::chrono::floor<milliseconds>(time));
  };
  EXPECT_THAT(text_of(walk(3'000, microseconds(250), in_ms)), IsEmpty());
  // Frames of many devices at one time are no frozen clock.
  auto crowd = walk(40, Duration(0), as_is);
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    crowd[i].transmitter.octets[5] = static_cast<std::uint8_t>(i);
  }
  EXPECT_THAT(text_of(crowd), IsEmpty());
}

}  // namespace
}  // namespace rayloc::field_stamp_check_test
