#include "engine/track/grid_filter.h"
#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "engine/em/radio_material.h"
#include "tests/support/box_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::grid_filter_test {
namespace {

constexpr double kHeight = 1.0;  // [m]

// A room of 4 x 2 m that a wall at x = 0 divides, and a cupboard in the right half.
std::shared_ptr<const FreeSpace> divided_room() {
  const auto scene = test::make_scene({{"wall", test::box_mesh({-0.05, -1, 0}, {0.05, 1, 2})},
                                       {"cupboard", test::box_mesh({1, 0, 0}, {1.5, 1, 2})},
                                       {"table", test::box_mesh({-1, 0, 0}, {-0.5, 1, 0.7})}},
                                      test::kConcrete);
  const Grid grid({-2, -1, 0}, {2, 1, 2}, kHeight, 0.1);
  return std::make_shared<const FreeSpace>(make_free_space(*scene, grid, {}));
}

// A room of 8 x 8 m without anything in it.
std::shared_ptr<const FreeSpace> empty_room() {
  const Grid grid({-4, -4, 0}, {4, 4, 2}, kHeight, 0.1);
  const std::vector<std::uint8_t> all(grid.size(), 1);
  FreeSpace space{grid, all, all, all};
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 ? 1 : 0;
  }
  return std::make_shared<const FreeSpace>(std::move(space));
}

std::size_t cell_near(const Grid& grid, double x, double y) {
  std::size_t best = 0;
  const auto distance = [&](std::size_t cell) {
    return std::hypot(grid.centre(cell).x - x, grid.centre(cell).y - y);
  };
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    best = distance(cell) < distance(best) ? cell : best;
  }
  return best;
}

// A burst that is sure of one cell.
void put_at(GridFilter& filter, const Grid& grid, double x, double y) {
  std::vector<double> map(grid.size(), -200.0);
  map[cell_near(grid, x, y)] = 0.0;
  filter.update(map, 1.0);
}

double probability(const GridFilter& filter, const Grid& grid, auto where) {
  const auto mass = filter.mass();
  double sum = 0.0;
  for (std::size_t cell = 0; cell < mass.size(); ++cell) {
    sum += where(grid.centre(cell)) ? mass[cell] : 0.0;
  }
  return sum;
}

// Mean of the mass along x [m].
double mean_x(const GridFilter& filter, const Grid& grid) {
  const auto mass = filter.mass();
  double mean = 0.0;
  for (std::size_t cell = 0; cell < mass.size(); ++cell) {
    mean += mass[cell] * grid.centre(cell).x;
  }
  return mean;
}

double variance_x(const GridFilter& filter, const Grid& grid) {
  const auto mass = filter.mass();
  const double mean = mean_x(filter, grid);
  double variance = 0.0;
  for (std::size_t cell = 0; cell < mass.size(); ++cell) {
    variance += mass[cell] * std::pow(grid.centre(cell).x - mean, 2);
  }
  return variance;
}

// A target that walks, or is at rest, for good.
MotionModel surely(double change_odds) {
  MotionModel motion;
  motion.outlier = 0.0;
  motion.switching_rate = 0.0;
  motion.change_odds = change_odds;
  return motion;
}

TEST(FreeSpace, TallFurnitureBlocksAndTablesDoNot) {
  const auto space = divided_room();
  EXPECT_EQ(space->free[cell_near(space->grid, 1.25, 0.5)], 0);
  EXPECT_EQ(space->free[cell_near(space->grid, -0.75, 0.5)], 1);
  EXPECT_EQ(space->free[cell_near(space->grid, 1.25, -0.5)], 1);
}

TEST(FreeSpace, HullAroundAnAccessPointIsFree) {
  const auto scene =
      test::make_scene({{"room", test::box_mesh({-2, -1, 0}, {2, 1, 2})}}, test::kConcrete);
  const Grid grid({-2, -1, 0}, {2, 1, 2}, kHeight, 0.1);
  const FreeSpace space = make_free_space(*scene, grid, {{1.0, 0.5, 1.5}});
  EXPECT_EQ(std::accumulate(space.free.begin(), space.free.end(), std::size_t{0}), grid.size());
}

TEST(FreeSpace, OpenCellsAreReachedWithoutPassingAWall) {
  const auto space = divided_room();
  const Grid& grid = space->grid;
  const auto is_open_between = [&](double x0, double y0, double x1, double y1) {
    const std::size_t from = cell_near(grid, x0, y0);
    const std::size_t to = cell_near(grid, x1, y1);
    EXPECT_EQ(is_open(*space, from, to), is_open(*space, to, from));
    return is_open(*space, from, to);
  };
  EXPECT_TRUE(is_open_between(-1.05, 0.05, -1.05, 0.05));
  EXPECT_TRUE(is_open_between(-1.05, 0.05, -0.55, -0.35));
  EXPECT_TRUE(is_open_between(-0.45, 0.35, -0.85, -0.15));
  EXPECT_FALSE(is_open_between(-0.25, 0.05, 0.25, 0.05));   // the wall
  EXPECT_FALSE(is_open_between(-0.25, 0.05, 0.35, -0.35));  // the wall, at an angle
  EXPECT_FALSE(is_open_between(0.85, 0.05, 1.25, 0.05));    // into the cupboard
  EXPECT_TRUE(is_open_between(0.75, 0.25, 1.15, -0.15));    // around its corner, y first
}

TEST(GridFilter, IsSetToTheModesOfAnother) {
  const auto space = divided_room();
  MotionModel motion;
  motion.outlier = 0.0;
  GridFilter filter(space, motion);
  put_at(filter, space->grid, -1.05, 0.25);
  filter.predict(from_seconds(0.3));
  filter.narrow(1e-4, from_seconds(0.1));
  ASSERT_FALSE(filter.window().is_all_of(space->grid));
  const auto modes = filter.modes();
  ASSERT_EQ(modes.size(), 17U);
  EXPECT_EQ(modes[0].velocity_x, 0.0);
  EXPECT_EQ(modes[0].velocity_y, 0.0);
  EXPECT_NEAR(modes[9].velocity_x, 1.0, 1e-12);
  std::vector<std::vector<float>> mass(modes.size(), std::vector<float>(space->grid.size()));
  for (std::size_t k = 0; k < modes.size(); ++k) {
    ASSERT_EQ(modes[k].mass.size(), filter.window().size());
    for (std::size_t n = 0; n < modes[k].mass.size(); ++n) {
      mass[k][filter.window().cell(n, space->grid)] = 7.0F * modes[k].mass[n];
    }
    mass[k][cell_near(space->grid, 1.25, 0.5)] = 1.0F;  // in the cupboard
  }
  GridFilter other(space, {});
  other.set(mass);
  EXPECT_TRUE(other.window().is_all_of(space->grid));
  EXPECT_EQ(other.away(), 0.0);
  EXPECT_NEAR(other.stationary(), filter.stationary(), 1e-4);
  const std::vector<double> of_filter = filter.mass();
  const std::vector<double> of_other = other.mass();
  for (std::size_t n = 0; n < of_filter.size(); ++n) {
    EXPECT_NEAR(of_other[filter.window().cell(n, space->grid)], of_filter[n], 1e-5);
  }
  EXPECT_EQ(of_other[cell_near(space->grid, 1.25, 0.5)], 0.0);
}

TEST(GridFilter, StartsEverywhereThatIsFree) {
  const auto space = divided_room();
  const GridFilter filter(space, {});
  const auto mass = filter.mass();
  EXPECT_NEAR(std::accumulate(mass.begin(), mass.end(), 0.0), 1.0, 1e-12);
  EXPECT_EQ(mass[cell_near(space->grid, 1.25, 0.5)], 0.0);
  EXPECT_NEAR(filter.stationary(), 0.5, 1e-6);
}

TEST(GridFilter, NoWalkCrossesAWall) {
  const auto space = divided_room();
  GridFilter filter(space, {});
  for (int i = 0; i < 40; ++i) {  // sure of it: what is left on the other side vanishes
    put_at(filter, space->grid, -0.25, 0.0);
  }
  filter.predict(std::chrono::seconds(60));
  EXPECT_LT(probability(filter, space->grid, [](const Vec3d& p) { return p.x > 0.0; }), 1e-12);
  EXPECT_GT(probability(filter, space->grid, [](const Vec3d& p) { return p.x < -1.5; }), 0.05);
}

TEST(GridFilter, NoWalkEndsInACupboard) {
  const auto space = divided_room();
  GridFilter filter(space, {});
  put_at(filter, space->grid, 1.25, -0.3);
  filter.predict(std::chrono::seconds(10));
  const auto inside = [](const Vec3d& p) { return p.x > 1.0 && p.x < 1.5 && p.y > 0.0; };
  EXPECT_EQ(probability(filter, space->grid, inside), 0.0);
}

TEST(GridFilter, WalkSpreadsAtItsSpeed) {
  const auto space = empty_room();
  MotionModel motion = surely(1e20);
  motion.walking_speeds = {0.8};
  motion.direction_time = 1e6;
  GridFilter filter(space, motion);
  filter.weigh_change(1.0);
  put_at(filter, space->grid, 0.05, 0.05);
  filter.predict(std::chrono::seconds(2));
  // On a circle of 1.6 m; what lies between two cells is shared by both.
  EXPECT_NEAR(variance_x(filter, space->grid), 0.5 * 1.6 * 1.6, 0.1);
  EXPECT_NEAR(mean_x(filter, space->grid), 0.05, 1e-3);
}

TEST(GridFilter, ChangingDirectionShortensAWalk) {
  const auto space = empty_room();
  std::vector<double> variances;
  for (const double direction_time : {1e6, 1.0, 0.3}) {
    MotionModel motion = surely(1e20);
    motion.direction_time = direction_time;
    GridFilter filter(space, motion);
    filter.weigh_change(1.0);
    put_at(filter, space->grid, 0.05, 0.05);
    filter.predict(std::chrono::seconds(2));
    variances.push_back(variance_x(filter, space->grid));
  }
  EXPECT_LT(variances[1], 0.8 * variances[0]);
  EXPECT_LT(variances[2], 0.8 * variances[1]);
}

TEST(GridFilter, WalkGoesOnWhereItWasGoing) {
  const auto space = empty_room();
  GridFilter filter(space, {});
  for (int i = 0; i <= 20; ++i) {  // 0.5 m/s
    put_at(filter, space->grid, -1.0 + 0.05 * i, 0.05);
    filter.predict(std::chrono::milliseconds(100));
  }
  const double before = mean_x(filter, space->grid);
  filter.predict(std::chrono::milliseconds(500));
  EXPECT_GT(mean_x(filter, space->grid), before + 0.1);
}

TEST(GridFilter, MotionlessTargetStays) {
  const auto space = empty_room();
  GridFilter filter(space, surely(1e20));
  filter.weigh_change(0.0);  // it is at rest
  put_at(filter, space->grid, 0.05, 0.05);
  filter.predict(std::chrono::seconds(1));
  EXPECT_GT(filter.mass()[cell_near(space->grid, 0.05, 0.05)], 1.0 - 1e-9);
}

TEST(GridFilter, ChangeSeparatesWalkingFromRest) {
  const auto space = empty_room();
  GridFilter filter(space, {});
  filter.weigh_change(0.0);
  EXPECT_NEAR(filter.stationary(), 10.0 / 11.0, 1e-6);
  filter.weigh_change(1.0);
  EXPECT_NEAR(filter.stationary(), 0.5, 1e-6);
}

TEST(GridFilter, WindowMatchesTheWholeRoom) {
  const auto space = empty_room();
  GridFilter whole(space, {});
  put_at(whole, space->grid, 1.0, -1.0);
  put_at(whole, space->grid, 1.0, -1.0);
  GridFilter narrowed = whole;
  const Duration time = std::chrono::milliseconds(200);
  narrowed.narrow(1e-3, time);
  EXPECT_LT(narrowed.window().size(), space->grid.size() / 4);
  whole.predict(time);
  narrowed.predict(time);
  EXPECT_LT(narrowed.away(), 2e-3);
  const auto all = whole.mass();
  const auto part = narrowed.mass();
  for (std::size_t n = 0; n < part.size(); ++n) {
    EXPECT_NEAR(part[n], all[narrowed.window().cell(n, space->grid)], 2e-3);
  }
  narrowed.widen();
  EXPECT_EQ(narrowed.window().size(), space->grid.size());
  EXPECT_EQ(narrowed.away(), 0.0);
  EXPECT_NEAR(mean_x(narrowed, space->grid), mean_x(whole, space->grid), 0.01);
}

TEST(GridFilter, RecoversFromOneWrongBurst) {
  const auto space = empty_room();
  GridFilter filter(space, {});
  for (int i = 0; i < 3; ++i) {
    put_at(filter, space->grid, 1.05, 1.05);
  }
  put_at(filter, space->grid, -2.05, -2.05);
  EXPECT_GT(filter.mass()[cell_near(space->grid, 1.05, 1.05)], 0.99);
}

}  // namespace
}  // namespace rayloc::grid_filter_test
