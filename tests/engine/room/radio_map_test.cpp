#include "engine/room/radio_map.h"

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/base/constants.h"
#include "tests/support/scenes.h"

namespace rayloc::radio_map_test {
namespace {

AntennaArray antenna_at(const Vec3d& position) {
  AntennaArray array;
  array.pose.position = position;
  array.element_offset = {Vec3d{}};
  return array;
}

// A floor of metal far below: two paths, the straight one and the reflection.
class RadioMapTest : public ::testing::Test {
 protected:
  std::shared_ptr<const Scene> scene_ =
      test::make_scene({{"floor", test::box_mesh({-20, -20, -1}, {20, 20, 0})}}, test::kConcrete);
};

TEST_F(RadioMapTest, GridLiesInTheMiddleOfTheRectangle) {
  const RadioMapGrid grid = radio_map_grid({0.0, 0.0, 0.0}, {1.0, 0.65, 0.0}, 1.2, 0.2);
  EXPECT_EQ(grid.count_x, 5U);
  EXPECT_EQ(grid.count_y, 3U);
  EXPECT_NEAR(grid.middle(0).x, 0.1, 1e-12);
  EXPECT_NEAR(grid.middle(0).y, 0.125, 1e-12);
  EXPECT_NEAR(grid.middle(14).x, 0.9, 1e-12);
  EXPECT_NEAR(grid.middle(14).y, 0.525, 1e-12);
  EXPECT_EQ(grid.middle(7).z, 1.2);
  EXPECT_EQ(radio_map_grid({0.0, 0.0, 0.0}, {0.1, 0.1, 0.0}, 1.2, 0.2).size(), 1U);
}

// Free space (Friis) where depth 0 leaves the straight path alone.
TEST_F(RadioMapTest, IsFreeSpaceWhereNothingReflects) {
  const PathTracer tracer(scene_, {.max_depth = 0});
  const RadioMapGrid grid = radio_map_grid({1.0, -2.0, 0.0}, {5.0, 2.0, 0.0}, 1.5, 1.0);
  const RadioMap map = radio_map(tracer, antenna_at({0.0, 0.0, 1.5}), grid);
  const double wavelength = kSpeedOfLight / scene_->carrier_hz();
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const double distance = std::hypot(grid.middle(cell).x, grid.middle(cell).y);
    const double expected = std::pow(wavelength / (4.0 * std::numbers::pi * distance), 2.0);
    EXPECT_NEAR(map.path_gain[cell], expected, 1e-12 * expected);
    EXPECT_NEAR(map.delay_spread[cell], 0.0, 1e-20);
    EXPECT_EQ(map.path_count[cell], 1U);
  }
}

// Two paths of powers p and q whose delays differ by d: the spread is d sqrt(p q) / (p + q).
TEST_F(RadioMapTest, TwoPathsHaveTheSpreadOfTheirPowers) {
  const PathTracer tracer(scene_, {.max_depth = 1});
  const Vec3d antenna{0.0, 0.0, 2.0};
  const RadioMapGrid grid = radio_map_grid({2.0, 0.0, 0.0}, {6.0, 1.0, 0.0}, 1.0, 1.0);
  const RadioMap map = radio_map(tracer, antenna_at(antenna), grid);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    Transmitter device;
    device.position = grid.middle(cell);
    Receiver receiver;
    receiver.position = antenna;
    const Paths paths = tracer.trace(device, receiver);
    ASSERT_EQ(paths.size(), 2U);
    const double p = abs2(paths[0].a);
    const double q = abs2(paths[1].a);
    const double apart = std::abs(paths[1].tau - paths[0].tau);
    EXPECT_EQ(map.path_count[cell], 2U);
    EXPECT_NEAR(map.path_gain[cell], p + q, 1e-12 * p);
    EXPECT_NEAR(map.delay_spread[cell], apart * std::sqrt(p * q) / (p + q), 1e-6 * apart);
  }
}

TEST_F(RadioMapTest, MarksCellsWithoutAnyPath) {
  const PathTracer tracer(scene_, {.max_depth = 1});
  const RadioMapGrid below = radio_map_grid({1.0, 1.0, 0.0}, {2.0, 2.0, 0.0}, -2.0, 1.0);
  const RadioMap map = radio_map(tracer, antenna_at({0.0, 0.0, 2.0}), below);
  EXPECT_EQ(map.path_gain[0], 0.0);
  EXPECT_EQ(map.path_count[0], 0U);
  EXPECT_TRUE(std::isnan(map.delay_spread[0]));
  EXPECT_EQ(strongest_of({map})[0], -1);
  // An antenna does not receive itself.
  const RadioMapGrid here = radio_map_grid({0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, 2.0, 0.5);
  EXPECT_EQ(radio_map(tracer, antenna_at({0.25, 0.25, 2.0}), here).path_count[0], 0U);
}

TEST_F(RadioMapTest, TheNearestIsTheLoudestOverAFlatFloor) {
  const PathTracer tracer(scene_, {.max_depth = 1});
  const RadioMapGrid grid = radio_map_grid({-4.0, 0.0, 0.0}, {4.0, 1.0, 0.0}, 1.0, 1.0);
  const RadioMap west = radio_map(tracer, antenna_at({-3.0, 0.0, 2.0}), grid);
  const RadioMap east = radio_map(tracer, antenna_at({3.0, 0.0, 2.0}), grid);
  const auto strongest = strongest_of({west, east});
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    EXPECT_EQ(strongest[cell], grid.middle(cell).x < 0.0 ? 0 : 1);
  }
}

}  // namespace
}  // namespace rayloc::radio_map_test
