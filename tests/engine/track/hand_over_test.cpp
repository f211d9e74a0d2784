#include "engine/track/hand_over.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/posterior/cell_places.h"
#include "engine/track/cloud_summary.h"
#include "tests/support/box_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::hand_over_test {
namespace {

constexpr double kHeight = 1.0;  // [m]

// A room of 4 x 4 m without anything in it, cells of 5 cm.
std::shared_ptr<const FreeSpace> open_room(double height_sigma) {
  Grid grid({-2, -2, 0}, {2, 2, 2.5}, kHeight, 0.05);
  grid.height_sigma = height_sigma;
  grid.layers = height_layers({kHeight, height_sigma}, 0.0, 2.5);
  const std::vector<std::uint8_t> all(grid.size(), 1);
  FreeSpace space{grid, all, all, all};
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 ? 1 : 0;
    space.link_x[cell] = cell + grid.count_y < grid.size() ? 1 : 0;
  }
  return std::make_shared<const FreeSpace>(std::move(space));
}

struct PlacedMass {
  double x;     // [m]
  double y;     // [m]
  double mass;  // relative
  double resting;
  std::size_t mode;  // of the part that walks
};

GridFilter filter_of(const std::shared_ptr<const FreeSpace>& space,
                     const std::vector<PlacedMass>& masses) {
  GridFilter filter(space, {});
  std::vector<std::vector<float>> mass(filter.modes().size(),
                                       std::vector<float>(space->grid.size()));
  for (const PlacedMass& one : masses) {
    const std::size_t cell = space->grid.cell_at(one.x, one.y);
    mass[0][cell] += static_cast<float>(one.mass * one.resting);
    mass[one.mode][cell] += static_cast<float>(one.mass * (1.0 - one.resting));
  }
  filter.set(mass);
  return filter;
}

// A best place in layer `layer`, and a rest that is evenly distributed in three layers and leans.
CellMass refined_cell(const Grid& grid, std::size_t layer, double best_share) {
  const HeightLayers& heights = grid.layers;
  const double even = heights.thickness * heights.thickness / 12.0;
  CellMass cell;
  cell.best = {0.012, -0.008, 4e-6, 1e-6, 9e-6, heights.offset[layer], 1e-5, -2e-5, 4e-4};
  cell.best_share = best_share;
  cell.layers.assign(heights.size(), 0.0F);
  cell.layers[layer] = static_cast<float>(best_share);
  std::vector<WeightedMoments> parts{{best_share, cell.best}};
  for (std::size_t i = 0; i < 3; ++i) {
    const double share = (1.0 - best_share) * (i == 0 ? 0.5 : 0.25);
    const double lean = 0.006 * static_cast<double>(i);
    parts.push_back(
        {share, {-0.01 + lean, 0.004, 1e-4, 2e-5, 8e-5, heights.offset[i], 0.0, 0.0, even}});
    cell.layers[i] += static_cast<float>(share);
  }
  cell.all = mixture_of(parts);
  return cell;
}

CellMoments moments_of(const PlaceCloud& cloud) {
  std::vector<WeightedMoments> parts;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    CellMoments place;
    place.x = static_cast<double>(cloud.x()[i]);
    place.y = static_cast<double>(cloud.y()[i]);
    place.z = static_cast<double>(cloud.z()[i]);
    parts.push_back({1.0 / static_cast<double>(cloud.size()), place});
  }
  return mixture_of(parts);
}

void expect_same_moments(const CellMoments& found, const CellMoments& expected, double count) {
  const double error = 3.0 / std::sqrt(count);
  EXPECT_NEAR(found.x, expected.x, error * std::sqrt(expected.xx));
  EXPECT_NEAR(found.y, expected.y, error * std::sqrt(expected.yy));
  EXPECT_NEAR(found.z, expected.z, error * std::sqrt(expected.zz));
  const auto product = [&](double of_found, double of_expected, double a, double b) {
    EXPECT_NEAR(of_found, of_expected, 1.5 * error * std::sqrt(a * b));
  };
  product(found.xx, expected.xx, expected.xx, expected.xx);
  product(found.xy, expected.xy, expected.xx, expected.yy);
  product(found.yy, expected.yy, expected.yy, expected.yy);
  product(found.xz, expected.xz, expected.xx, expected.zz);
  product(found.yz, expected.yz, expected.yy, expected.zz);
  product(found.zz, expected.zz, expected.zz, expected.zz);
}

TEST(HandOver, KeepsTheMomentsOfCells) {
  constexpr std::size_t kPlaces = 20000;
  const auto space = open_room(0.3);
  const Grid& grid = space->grid;
  // One cell alone, so that its own moments are tested, and three of which one is not refined.
  const std::vector<std::vector<PlacedMass>> cases{
      {{0.325, 0.125, 1.0, 0.7, 3}},
      {{0.325, 0.125, 0.5, 0.9, 3}, {0.375, 0.125, 0.3, 0.2, 12}, {-0.525, 1.025, 0.2, 0.0, 7}}};
  for (const auto& masses : cases) {
    const GridFilter filter = filter_of(space, masses);
    RefinedCells within{
        {grid.cell_at(0.325, 0.125), refined_cell(grid, 3, 0.6)},
        {grid.cell_at(0.375, 0.125), refined_cell(grid, 5, 0.2)},
    };
    std::vector<double> layers(grid.layers.size(), 0.0);
    layers[2] = 0.7;
    layers[4] = 0.3;
    std::vector<WeightedMoments> parts;
    std::vector<double> of_layers(layers.size(), 0.0);
    double resting = 0.0;
    for (std::size_t i = 0; i < masses.size(); ++i) {
      const Vec3d centre = grid.centre(grid.cell_at(masses[i].x, masses[i].y));
      const auto add = [&](double share, CellMoments m) {
        m.x += centre.x;
        m.y += centre.y;
        m.z += centre.z;
        parts.push_back({share, m});
      };
      resting += masses[i].mass * masses[i].resting;
      if (i < within.size()) {
        add(masses[i].mass, within[i].second.all);
      }
      for (std::size_t k = 0; k < layers.size(); ++k) {
        if (i < within.size()) {
          of_layers[k] += masses[i].mass * static_cast<double>(within[i].second.layers[k]);
          continue;
        }
        CellMoments m = uniform_moments(grid);
        m.z = grid.layers.offset[k];
        m.zz = grid.layers.thickness * grid.layers.thickness / 12.0;
        add(masses[i].mass * layers[k], m);
        of_layers[k] += masses[i].mass * layers[k];
      }
    }
    NormalDraws draws(11);
    const PlaceCloud cloud = cloud_of(filter, *space, within, layers, kPlaces, draws);
    ASSERT_EQ(cloud.size(), kPlaces);
    expect_same_moments(moments_of(cloud), mixture_of(parts), kPlaces);
    EXPECT_NEAR(cloud.resting(), resting, 1e-3);
    const std::vector<double> found = layers_of(cloud, grid);
    ASSERT_EQ(found.size(), of_layers.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k], of_layers[k], 0.015) << k;
    }
  }
}

TEST(HandOver, ADeviceAtRestKeepsItsCentimetre) {
  for (const double height_sigma : {0.0, 0.3}) {
    const auto space = open_room(height_sigma);
    const Grid& grid = space->grid;
    const GridFilter filter = filter_of(space, {{0.325, 0.125, 1.0, 1.0, 1}});
    CellMass cell;
    cell.best = {0.011, -0.007, 25e-6, 0.0, 25e-6, 0.0, 0.0, 0.0, 0.0};
    cell.all = cell.best;
    const std::vector<double> layers;
    NormalDraws draws(12);
    const PlaceCloud cloud =
        cloud_of(filter, *space, {{grid.cell_at(0.325, 0.125), cell}}, layers, 600, draws);
    EXPECT_EQ(cloud.resting(), 1.0);
    LocationEstimate location;
    summarise_cloud(cloud, grid, {}, {}, location);
    ASSERT_TRUE(location.position);
    EXPECT_NEAR(location.position->x, 0.336, 0.001);
    EXPECT_NEAR(location.position->y, 0.118, 0.001);
    EXPECT_NEAR(location.position->z, kHeight, height_sigma > 0.0 ? 0.01 : 1e-6);
    EXPECT_NEAR(std::sqrt(location.covariance[0]), std::hypot(0.005, 0.01), 0.001);
  }
}

TEST(HandOver, VelocitiesAreThoseOfTheModes) {
  const auto space = open_room(0.0);
  const GridFilter filter = filter_of(space, {{0.325, 0.125, 1.0, 0.25, 11}});
  const auto modes = filter.modes();
  NormalDraws draws(13);
  const PlaceCloud cloud = cloud_of(filter, *space, {}, {}, 400, draws);
  std::size_t resting = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const CloudPlace place = cloud.place(i);
    resting += place.is_resting ? 1 : 0;
    EXPECT_NEAR(place.u, place.is_resting ? 0.0 : modes[11].velocity_x, 1e-6);
    EXPECT_NEAR(place.v, place.is_resting ? 0.0 : modes[11].velocity_y, 1e-6);
    EXPECT_EQ(place.variance, place.is_resting ? 0.0F : 0.09F);
    EXPECT_NEAR(place.z, kHeight, 1e-6);
  }
  EXPECT_NEAR(static_cast<double>(resting), 100.0, 1.0);
}

TEST(HandOver, TheGridHasTheMassesOfTheCloud) {
  const auto space = open_room(0.3);
  const Grid& grid = space->grid;
  PlaceCloud cloud;
  NormalDraws draws(14);
  for (int i = 0; i < 900; ++i) {
    CloudPlace place;
    place.x = 0.5F + 0.1F * draws.normal();
    place.y = -0.3F + 0.2F * draws.normal();
    place.is_resting = i % 3 == 0;
    place.u = place.is_resting ? 0.0F : 1.02F;
    place.v = place.is_resting ? 0.0F : 0.05F;
    cloud.add(place, 0.5F * draws.normal());
  }
  std::vector<double> expected(grid.size());
  const std::vector<float> weights = cloud.weights();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    expected[grid.cell_at(static_cast<double>(cloud.x()[i]), static_cast<double>(cloud.y()[i]))] +=
        static_cast<double>(weights[i]);
  }
  for (const double elsewhere : {0.0, 0.1}) {
    const GridFilter filter = grid_of(cloud, space, {}, elsewhere);
    const double each = elsewhere / static_cast<double>(grid.size());
    const std::vector<double> mass = filter.mass();
    for (std::size_t cell = 0; cell < grid.size(); ++cell) {
      ASSERT_NEAR(mass[cell], (1.0 - elsewhere) * expected[cell] + each, 1e-6);
    }
    EXPECT_NEAR(filter.stationary(), (1.0 - elsewhere) * cloud.resting() + 0.5 * elsewhere, 1e-5);
    double along_x = 0.0;
    for (const GridFilter::ModeView& mode : filter.modes()) {
      if (mode.velocity_x > 0.99) {
        for (const float one : mode.mass) {
          along_x += static_cast<double>(one);
        }
      }
    }
    EXPECT_NEAR(
        along_x, (1.0 - elsewhere) * (1.0 - cloud.resting()) + 0.5 * elsewhere / 16.0, 1e-5);
  }
}

TEST(HandOver, AWalkOfUnknownDirectionHasAllDirections) {
  const auto space = open_room(0.0);
  PlaceCloud cloud;
  CloudPlace place;
  place.variance = 0.36F;
  cloud.add(place, 0.0F);
  const GridFilter filter = grid_of(cloud, space, {}, 0.0);
  const std::size_t cell = space->grid.cell_at(0.0, 0.0);
  const auto modes = filter.modes();
  for (std::size_t k = 1; k < modes.size(); ++k) {
    EXPECT_NEAR(modes[k].mass[cell], k <= 8 ? 0.125 : 0.0, 1e-6) << k;
  }
}

TEST(HandOver, WithoutAPlaceInAFreeCellTheGridIsUniform) {
  const auto space = open_room(0.0);
  PlaceCloud cloud;
  CloudPlace place;
  place.x = 5.0F;
  cloud.add(place, 0.0F);
  const GridFilter filter = grid_of(cloud, space, {}, 0.05);
  EXPECT_NEAR(filter.mass()[17], 1.0 / static_cast<double>(space->grid.size()), 1e-9);
  EXPECT_NEAR(filter.stationary(), 0.5, 1e-5);
}

TEST(HandOver, DrawsNoPlaceBehindAWall) {
  const auto scene = test::make_scene({{"wall", test::box_mesh({-0.02, -2, 0}, {0.02, 2, 2})},
                                       {"cupboard", test::box_mesh({1, 0, 0}, {1.5, 1, 2})}},
                                      test::kConcrete);
  const Grid grid({-2, -2, 0}, {2, 2, 2}, kHeight, 0.1);
  const auto space = std::make_shared<const FreeSpace>(make_free_space(*scene, grid, {}));
  const GridFilter filter =
      filter_of(space, {{-0.05, 0.15, 0.5, 0.5, 1}, {0.95, 0.55, 0.5, 0.5, 1}});
  CellMass wide;
  wide.best = {0.04, 0.0, 0.01, 0.0, 0.01};
  wide.all = wide.best;
  NormalDraws draws(15);
  const RefinedCells within{{grid.cell_at(-0.05, 0.15), wide}, {grid.cell_at(0.95, 0.55), wide}};
  const PlaceCloud cloud = cloud_of(filter, *space, within, {}, 2000, draws);
  double left = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.x()[i]);
    const std::size_t cell = grid.cell_at(x, static_cast<double>(cloud.y()[i]));
    ASSERT_LT(cell, grid.size());
    EXPECT_NE(space->free[cell], 0);
    left += x < 0.0 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(left, 1000.0, 1.0);
}

TEST(HandOver, IsTheSameForTheSameKey) {
  const auto space = open_room(0.3);
  const GridFilter filter(space, {});
  const auto run = [&](std::uint64_t key) {
    NormalDraws draws(key);
    const PlaceCloud cloud = cloud_of(filter, *space, {}, {}, 500, draws);
    return std::vector<float>(cloud.z().begin(), cloud.z().end());
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

}  // namespace
}  // namespace rayloc::hand_over_test
