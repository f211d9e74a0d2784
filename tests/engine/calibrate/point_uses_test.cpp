#include "engine/calibrate/point_uses.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::point_uses_test {
namespace {

// Points with a burst at one access point; every fifth is held out.
std::vector<CalibrationPoint> received_points(std::size_t count) {
  std::vector<CalibrationPoint> points(count);
  for (std::size_t p = 0; p < count; ++p) {
    points[p].held_out = p % 5 == 4;
    points[p].h = {{1.0}};
  }
  return points;
}

std::ptrdiff_t count_of(const std::vector<Use>& uses, Use use) {
  return std::count(uses.begin(), uses.end(), use);
}

TEST(PointUses, DrawAFixedShareForEverySeed) {
  const auto points = received_points(150);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto uses = draw_uses(points, seed);
    EXPECT_EQ(count_of(uses, Use::kHeldOut), 30);
    EXPECT_EQ(count_of(uses, Use::kDecide), 18);  // 15 of 100 of 120
  }
}

TEST(PointUses, LeaveEnoughToDecideAndToFitInSmallSurveys) {
  for (const auto& [count, deciding] :
       {std::pair(5, 0), std::pair(10, 2), std::pair(15, 3), std::pair(25, 3), std::pair(40, 5)}) {
    const auto uses = draw_uses(received_points(static_cast<std::size_t>(count)), 1);
    EXPECT_EQ(count_of(uses, Use::kDecide), deciding) << count;
    EXPECT_GE(count_of(uses, Use::kFit), 4) << count;
    EXPECT_EQ(deciders(uses)[0], deciding > 0 ? Use::kDecide : Use::kFit) << count;
  }
}

TEST(PointUses, NeverDecideByUnreceivedPoints) {
  auto points = received_points(40);
  for (std::size_t p = 0; p < 20; ++p) {
    points[p].h[0].clear();
  }
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto uses = draw_uses(points, seed);
    EXPECT_EQ(count_of({uses.begin(), uses.begin() + 20}, Use::kDecide), 0) << seed;
    EXPECT_EQ(fitted_points(points, uses), 16U);
  }
}

// Each point in its turn: no part of the room is always left out.
TEST(PointUses, EventuallyDrawEveryPoint) {
  const auto points = received_points(20);
  std::set<std::size_t> drawn;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto uses = draw_uses(points, seed);
    for (std::size_t p = 0; p < uses.size(); ++p) {
      if (uses[p] == Use::kDecide) {
        drawn.insert(p);
      }
    }
  }
  EXPECT_EQ(drawn.size(), 16U);
}

}  // namespace
}  // namespace rayloc::point_uses_test
