// Recordings whose time stamps jump at every record: what the look through them costs.
#include <gtest/gtest.h>

#include <random>

#include "capture/source/clock_pairs.h"

namespace rayloc::field_many_jumps_test {
namespace {

using Jumps = std::vector<ClockJump>;

ClockJump jump_of(Duration size) {
  ClockJump jump;
  jump.from = Timestamp(std::chrono::hours(450'000));
  jump.to = jump.from + size;
  return jump;
}

// The definition, word by word.
void mark_one_by_one(Jumps& jumps, Duration gap) {
  for (std::size_t i = 0; i < jumps.size(); ++i) {
    const Duration size = jumps[i].size();
    jumps[i].was_set = jumps[i].was_set || size < Duration::zero();
    for (std::size_t j = i; j-- > 0;) {
      const Duration other = jumps[j].size();
      const bool opposite = (other < Duration::zero()) != (size < Duration::zero());
      if (opposite && std::chrono::abs(other + size) <= gap) {
        jumps[i].was_set = jumps[j].was_set = true;
        break;
      }
    }
  }
}

TEST(Field, JumpsAreMarkedAsOneByOne) {
  std::mt19937 random(11);
  for (const int range : {3, 30, 3000}) {
    std::uniform_int_distribution<int> seconds(-range, range);
    for (int round = 0; round < 40; ++round) {
      Jumps jumps;
      for (int i = 0; i < 60; ++i) {
        jumps.push_back(jump_of(std::chrono::milliseconds(500) * seconds(random)));
      }
      Jumps expected = jumps;
      mark_one_by_one(expected, kMaxGap);
      mark_clocks_set(jumps, kMaxGap);
      for (std::size_t i = 0; i < jumps.size(); ++i) {
        ASSERT_EQ(jumps[i].was_set, expected[i].was_set) << range << ", " << i;
      }
    }
  }
}

TEST(Field, JumpsOfAnySizeOverflowNothing) {
  Jumps jumps = {jump_of(Duration::zero()), jump_of(Duration(-1))};
  for (const std::int64_t size : {INT64_MAX / 2, INT64_MIN / 2}) {
    ClockJump jump;
    jump.from = Timestamp(Duration(-size));
    jump.to = Timestamp(Duration(size));
    jumps.push_back(jump);
  }
  mark_clocks_set(jumps, kMaxGap);
  EXPECT_TRUE(jumps[2].was_set && jumps[3].was_set);
  EXPECT_TRUE(jumps[0].was_set && jumps[1].was_set);
}

// Twice as many jumps cost little more than twice the work, whatever their direction.
TEST(Field, TheWorkOfManyJumpsGrowsWithTheirNumber) {
  const auto work = [](std::size_t count, auto&& size_of) {
    Jumps jumps;
    for (std::size_t i = 0; i < count; ++i) {
      jumps.push_back(jump_of(size_of(i)));
    }
    return static_cast<double>(mark_clocks_set(jumps, kMaxGap));
  };
  const auto gaps = [](std::size_t) { return Duration(std::chrono::seconds(12)); };
  const auto back = [](std::size_t) { return Duration(std::chrono::seconds(-12)); };
  const auto growing = [](std::size_t i) {
    return Duration(std::chrono::seconds((i % 20 == 0 ? -20'000 : 1) * static_cast<int>(12 + i)));
  };
  constexpr std::size_t kCount = 20'000;
  EXPECT_LT(work(2 * kCount, gaps), 2.3 * work(kCount, gaps));
  EXPECT_LT(work(2 * kCount, back), 2.3 * work(kCount, back));
  EXPECT_LT(work(2 * kCount, growing), 2.3 * work(kCount, growing));
}

}  // namespace
}  // namespace rayloc::field_many_jumps_test
