// Damaged stamps that lie no further off than a silence may last: each could as well be the last
// record before a clock was set back.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "capture/source/record_times.h"

namespace rayloc::field_little_damage_test {
namespace {

using std::chrono::microseconds;
using Stamps = std::vector<std::int64_t>;  // [us]

constexpr std::int64_t kStart = 1'718'001'352'000'000;
constexpr std::int64_t kSecond = 1'000'000;

Timestamp at(std::int64_t us) { return Timestamp(microseconds(us)); }

// Frames of three datagrams, each 100 ms.
Stamps walk(int frames, std::int64_t from = kStart) {
  Stamps stamps;
  for (int i = 0; i < 3 * frames; ++i) {
    stamps.push_back(from + i / 3 * kSecond / 10 + i % 3 * 10);
  }
  return stamps;
}

RecordTimes times_of(const Stamps& stamps) {
  StampJudge judge({}, false);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    judge.add({i + 1, 24 + 16 * i}, at(stamps[i]));
  }
  return judge.finish();
}

std::uint64_t damaged_records(const RecordTimes& times) {
  return std::accumulate(
      times.damaged.begin(), times.damaged.end(), std::uint64_t{0}, [](auto sum, const auto& one) {
        return sum + one.records;
      });
}

// All records but those keep their stamps.
void expect_only_damaged(const Stamps& stamps, std::size_t first, std::size_t records) {
  const RecordTimes times = times_of(stamps);
  EXPECT_EQ(damaged_records(times), records);
  EXPECT_TRUE(times.jumps.empty());
  RecordClock clock(times);
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto time = clock.event_time(i + 1, at(stamps[i]));
    if (i >= first && i < first + records) {
      EXPECT_FALSE(time) << i;
    } else {
      ASSERT_TRUE(time) << i;
      ASSERT_EQ(*time, at(stamps[i])) << i;
    }
  }
}

TEST(Field, AStampDamagedByLittleMovesNoOther) {
  for (const std::int64_t error : {kSecond / 2, 9 * kSecond / 10, 5 * kSecond, 99 * kSecond / 10}) {
    for (const std::size_t where : {1U, 2U, 17U, 18U, 100U, 174U}) {
      SCOPED_TRACE(std::to_string(error) + " us at " + std::to_string(where));
      Stamps stamps = walk(60);
      stamps[where] += error;
      expect_only_damaged(stamps, where, 1);
    }
  }
}

TEST(Field, StampsOfAWholeFrameDamagedByLittleMoveNoOther) {
  Stamps stamps = walk(60);
  for (std::size_t i = 30; i < 36; ++i) {
    stamps[i] += 4 * kSecond;
  }
  expect_only_damaged(stamps, 30, 6);
}

// Twice in one recording: what was cut off before does not count again.
TEST(Field, SlightlyDamagedStampsAffectNoOtherRecord) {
  Stamps stamps = walk(60);
  for (const std::size_t where : {20U, 21U, 90U}) {
    stamps[where] += 3 * kSecond;
  }
  const RecordTimes times = times_of(stamps);
  EXPECT_EQ(damaged_records(times), 3U);
  EXPECT_TRUE(times.jumps.empty());
}

// A device that sends now and then, and a clock that was set back between: nothing is damaged.
TEST(Field, AClockThatWasSetBackBetweenSalvosLosesNothing) {
  for (const std::int64_t by : {kSecond, 5 * kSecond, 6 * kSecond, 9 * kSecond}) {
    Stamps stamps;
    for (int salvo = 0; salvo < 10; ++salvo) {
      const Stamps here =
          walk(3, kStart + salvo * 2 * kSecond - (salvo >= 5 ? by : std::int64_t{0}));
      stamps.insert(stamps.end(), here.begin(), here.end());
    }
    EXPECT_EQ(damaged_records(times_of(stamps)), 0U) << by;
  }
}

}  // namespace
}  // namespace rayloc::field_little_damage_test
