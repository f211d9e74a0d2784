#include "engine/localize/access_point_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/grid/height_layers.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::access_point_map_test {
namespace {

constexpr std::size_t kRemoved = 1;

std::vector<double> log_likelihoods(const AccessPointMap& map, const ObservedBurst& observed) {
  std::vector<double> values(map.cells());
  parallel_for(map.cells(), 8, [&](std::size_t cell) {
    map.fetch(cell + 1);
    if (map.is_reachable(cell)) {
      values[cell] = map.log_likelihood(cell, observed, map.coarse(cell, observed).windows);
    }
  });
  return values;
}

// The models of its cells are made on use, by several threads.
TEST(AccessPointMap, WithoutAnAntennaEqualsTheMapOfTheOtherAntennas) {
  for (const double height_sigma : {0.0, 0.2}) {
    const RoomModel room = test::make_room();
    Grid grid(room.bounds_min, room.bounds_max, 1.2, 0.25);
    grid.height_sigma = height_sigma;
    grid.layers = height_layers({1.2, height_sigma}, 0.0, 2.5);
    const AccessPointMap map({std::make_shared<const RoomModel>(room), 0, grid}, nullptr);
    RoomModel fewer = room;
    std::vector<Vec3d>& offsets = fewer.access_points[0].array.element_offset;
    offsets.erase(offsets.begin() + kRemoved);
    const AccessPointMap of_others({std::make_shared<const RoomModel>(fewer), 0, grid}, nullptr);
    const AccessPointMap& without = map.without(kRemoved);
    ASSERT_EQ(without.antennas(), of_others.antennas());
    ASSERT_EQ(without.cells(), of_others.cells());

    const auto h = of_others.expected(of_others.rays_to({0.3, -0.2, 1.2}));
    const ObservedBurst observed = of_others.observe(h, 1e-3);
    const std::vector<double> values = log_likelihoods(without, observed);
    EXPECT_EQ(values, log_likelihoods(of_others, observed)) << height_sigma;
    EXPECT_EQ(values, log_likelihoods(without, observed)) << "on second use, " << height_sigma;
    const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
    EXPECT_GT(*highest, *lowest);
    EXPECT_EQ(without.null_model(observed), of_others.null_model(observed));
    for (std::size_t cell = 0; cell < map.cells(); ++cell) {
      EXPECT_EQ(without.model(cell).mean, of_others.model(cell).mean);
    }
    EXPECT_EQ(&map.without(kRemoved), &without);
  }
}

}  // namespace
}  // namespace rayloc::access_point_map_test
