#include "daemon/lab/experiment/study_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rayloc::study_walk_test {
namespace {

// A room of 4 m by 3 m with a pillar in the middle, and how far a place is inside of it [m].
double clearance(const Vec3d& place) {
  return std::min({place.x - 0.3,
                   3.7 - place.x,
                   place.y - 0.3,
                   2.7 - place.y,
                   std::hypot(place.x - 2.0, place.y - 1.5) - 0.4});
}
bool is_free(const Vec3d& place) { return clearance(place) > 0.0; }

Vec3d any_place(RandomStream& random) {
  std::uniform_real_distribution<double> along_x(0.0, 4.0);
  std::uniform_real_distribution<double> along_y(0.0, 3.0);
  const double x = along_x(random);
  return {x, along_y(random), 1.2};
}

std::vector<Vec3d> walk_of(const WalkShape& shape, std::uint64_t seed) {
  RandomStream random = random_stream(seed, "walk");
  return draw_walk(shape, any_place, is_free, random);
}

TEST(StudyWalk, StaysWhereAPersonMayBe) {
  const WalkShape shape{.duration = 60.0, .rate = 100.0};
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const std::vector<Vec3d> walk = walk_of(shape, seed);
    ASSERT_EQ(walk.size(), 6000U);
    for (const Vec3d& place :
         walk) {  // arcs are checked each 4 cm: between them a corner may be cut
      ASSERT_GT(clearance(place), -0.001) << seed;
    }
    // It is a walk through the room, not a circle at one place.
    const auto [west, east] = std::minmax_element(
        walk.begin(), walk.end(), [](const Vec3d& a, const Vec3d& b) { return a.x < b.x; });
    EXPECT_GT(east->x - west->x, 1.5) << seed;
  }
}

// The step has the stated length, and no turn is narrower than stated.
TEST(StudyWalk, KeepsTheStatedSpeedAndMinimumRadius) {
  const WalkShape shape{.speed = 0.8, .duration = 20.0, .rate = 400.0};
  const std::vector<Vec3d> walk = walk_of(shape, 7);
  const double step = shape.speed / shape.rate;
  for (std::size_t i = 2; i < walk.size(); ++i) {
    const Vec3d before = walk[i - 1] - walk[i - 2];
    const Vec3d after = walk[i] - walk[i - 1];
    ASSERT_NEAR(std::hypot(after.x, after.y), step, 1e-6) << i;
    const double turn = std::atan2(before.x * after.y - before.y * after.x,
                                   before.x * after.x + before.y * after.y);
    ASSERT_LE(std::abs(turn), step / shape.turn_radius * 1.001) << i;
  }
}

// Another rate samples the same way: methods that need other rates are compared on it.
TEST(StudyWalk, RateDoesNotChangeTheRoute) {
  const std::vector<Vec3d> often = walk_of({.duration = 8.0, .rate = 400.0}, 3);
  const std::vector<Vec3d> seldom = walk_of({.duration = 8.0, .rate = 100.0}, 3);
  for (std::size_t i = 0; i < seldom.size(); ++i) {
    ASSERT_NEAR(often[4 * i].x, seldom[i].x, 1e-9) << i;
    ASSERT_NEAR(often[4 * i].y, seldom[i].y, 1e-9) << i;
  }
}

TEST(StudyWalk, GivesNoWalkIfEveryRouteIsTooNarrow) {
  RandomStream random = random_stream(1, "walk");
  const auto narrow = [](const Vec3d& place) { return place.y > 1.4 && place.y < 1.6; };
  EXPECT_TRUE(draw_walk({}, any_place, narrow, random).empty());
}

}  // namespace
}  // namespace rayloc::study_walk_test
