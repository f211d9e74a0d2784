#include "engine/track/cloud_summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/localize/search_area.h"
#include "engine/posterior/cell_places.h"
#include "engine/track/filter_summary.h"

namespace rayloc::cloud_summary_test {
namespace {

constexpr double kHeight = 1.1;  // [m]

// A room of 10 x 8 m with cells of 5 cm.
Grid room_grid() {
  Grid grid({0, 0, 0}, {10, 8, 2.5}, kHeight, 0.05);
  grid.height_sigma = 0.3;
  grid.layers = height_layers({kHeight, 0.3}, 0.0, 2.5);
  return grid;
}

struct Hill {
  double x;
  double y;
  double sigma;  // [m]
  std::size_t places;
  float u = 0.0F;  // [m/s]
};

PlaceCloud cloud_of_hills(const std::vector<Hill>& hills, std::uint64_t key) {
  NormalDraws draws(key);
  PlaceCloud cloud;
  for (const Hill& hill : hills) {
    for (std::size_t i = 0; i < hill.places; ++i) {
      CloudPlace place;
      place.x = static_cast<float>(hill.x + hill.sigma * static_cast<double>(draws.normal()));
      place.y = static_cast<float>(hill.y + hill.sigma * static_cast<double>(draws.normal()));
      place.z = static_cast<float>(kHeight + 0.2 + 0.05 * static_cast<double>(draws.normal()));
      place.u = hill.u;
      cloud.add(place, 0.2F * draws.normal());
    }
  }
  return cloud;
}

LocationEstimate summary_of(const PlaceCloud& cloud, const Grid& grid, double outlier = 0.0) {
  LocationEstimate location;
  PosteriorOptions options;
  options.outlier = outlier;
  EXPECT_EQ(summarise_cloud(cloud, grid, {}, options, location), 0.0);
  return location;
}

// The same masses in all cells of the room, with their places as distributions in the cells.
LocationEstimate summary_of_cells(const PlaceCloud& cloud, const Grid& grid, double outlier = 0.0) {
  std::vector<std::vector<WeightedMoments>> places(grid.size());
  std::vector<double> mass(grid.size());
  const std::vector<float> weights = cloud.weights();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d p{static_cast<double>(cloud.x()[i]),
                  static_cast<double>(cloud.y()[i]),
                  static_cast<double>(cloud.z()[i])};
    const std::size_t cell = static_cast<std::size_t>(p.x / grid.step_x) * grid.count_y +
                             static_cast<std::size_t>(p.y / grid.step_y);
    const Vec3d d = p - grid.centre(cell);
    const auto weight = static_cast<double>(weights[i]);
    mass[cell] += weight;
    places[cell].push_back({weight, {d.x, d.y, 0.0, 0.0, 0.0, d.z}});
  }
  RefinedCells within;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    for (WeightedMoments& one : places[cell]) {
      one.share /= mass[cell];
    }
    if (mass[cell] > 0.0) {
      const CellMoments moments = mixture_of(places[cell]);
      within.emplace_back(cell, CellMass{moments, moments, 1.0, {}});
    }
  }
  LocationEstimate location;
  PosteriorOptions options;
  options.outlier = outlier;
  summarise_posterior(grid, log_masses(mass), options, location, within);
  return location;
}

void expect_same(const LocationEstimate& found, const LocationEstimate& expected) {
  ASSERT_TRUE(found.position && expected.position);
  EXPECT_NEAR(found.position->x, expected.position->x, 0.01);
  EXPECT_NEAR(found.position->y, expected.position->y, 0.01);
  EXPECT_NEAR(found.accuracy_m, expected.accuracy_m, 0.05 * expected.accuracy_m);
  ASSERT_EQ(found.hypotheses.size(), expected.hypotheses.size());
  for (std::size_t i = 0; i < found.hypotheses.size(); ++i) {
    EXPECT_NEAR(found.hypotheses[i].weight, expected.hypotheses[i].weight, 0.02);
  }
  EXPECT_NEAR(found.residual_probability, expected.residual_probability, 0.02);
  EXPECT_EQ(found.ambiguous, expected.ambiguous);
}

TEST(CloudSummary, IsThatOfTheSameMassesInTheRoomsCells) {
  const Grid grid = room_grid();
  for (std::uint64_t key = 1; key <= 5; ++key) {
    for (const double outlier : {0.0, 0.03}) {
      const PlaceCloud one = cloud_of_hills({{4.03, 3.01, 0.12, 1500}}, key);
      expect_same(summary_of(one, grid, outlier), summary_of_cells(one, grid, outlier));
      const PlaceCloud two = cloud_of_hills({{4.03, 3.01, 0.08, 1000}, {7.0, 3.2, 0.1, 500}}, key);
      expect_same(summary_of(two, grid, outlier), summary_of_cells(two, grid, outlier));
    }
  }
}

TEST(CloudSummary, KeepsWidthsBelowACell) {
  const PlaceCloud cloud = cloud_of_hills({{4.03, 3.01, 0.004, 1500}}, 1);
  const LocationEstimate location = summary_of(cloud, room_grid());
  ASSERT_TRUE(location.position);
  EXPECT_NEAR(location.position->x, 4.03, 0.001);
  EXPECT_NEAR(location.position->y, 3.01, 0.001);
  EXPECT_NEAR(std::sqrt(location.covariance[0]), std::hypot(0.004, 0.01), 0.0005);
  // The height is that of the places, not of the grid.
  EXPECT_NEAR(location.position->z, kHeight + 0.2, 0.01);
  EXPECT_TRUE(location.is_height_estimated);
  EXPECT_NEAR(std::sqrt(location.covariance[8]), 0.051, 0.005);
}

TEST(CloudSummary, TwoHillsAreTwoHypotheses) {
  const Grid grid = room_grid();
  const PlaceCloud cloud = cloud_of_hills({{2.0, 2.0, 0.05, 900}, {4.5, 3.7, 0.05, 600}}, 2);
  const LocationEstimate location = summary_of(cloud, grid);
  ASSERT_EQ(location.hypotheses.size(), 2U);
  EXPECT_NEAR(location.hypotheses[0].weight, 0.6, 0.02);
  EXPECT_NEAR(location.hypotheses[1].weight, 0.4, 0.02);
  EXPECT_NEAR(location.hypotheses[0].position.x, 2.0, 0.01);
  EXPECT_NEAR(location.hypotheses[1].position.y, 3.7, 0.01);
  EXPECT_TRUE(location.ambiguous);
  EXPECT_NEAR(location.position->x, 2.0, 0.02);
}

TEST(CloudSummary, HasABoundedNumberOfCells) {
  const Grid grid = room_grid();
  const auto cells = [&](const PlaceCloud& cloud) {
    return summary_grid(cloud, cloud.weights(), grid).size();
  };
  for (const double sigma : {0.001, 0.02, 0.1, 0.2, 0.3, 0.5, 1.0}) {
    const PlaceCloud cloud = cloud_of_hills({{5.0, 4.0, sigma, 1500}}, 3);
    EXPECT_LE(cells(cloud), 1100U) << sigma;
    EXPECT_GE(cells(cloud), sigma > 0.2 ? 300U : 9U) << sigma;
    EXPECT_TRUE(summary_of(cloud, grid).position) << sigma;
  }
  PlaceCloud line;  // along a wall
  for (int i = 0; i < 1000; ++i) {
    CloudPlace place;
    place.x = 0.01F * static_cast<float>(i);
    place.y = 0.001F;
    line.add(place, 0.0F);
  }
  EXPECT_LE(cells(line), 1100U);
  const Grid long_hall({0, 0, 0}, {60, 2, 2.5}, kHeight, 0.02);
  EXPECT_LE(summary_grid(line, line.weights(), long_hall).size(), 1100U);
}

TEST(CloudSummary, WideCloudsKeepMomentsAndRadius) {
  const Grid grid = room_grid();
  const PlaceCloud cloud = cloud_of_hills({{5.0, 4.0, 0.6, 6000}}, 3);
  const LocationEstimate found = summary_of(cloud, grid);
  const LocationEstimate expected = summary_of_cells(cloud, grid);
  ASSERT_TRUE(found.position && expected.position);
  for (const std::size_t k : {0U, 1U, 4U, 8U}) {
    EXPECT_NEAR(found.covariance[k], expected.covariance[k], 0.1) << k;
  }
  EXPECT_NEAR(found.accuracy_m, expected.accuracy_m, 0.05 * expected.accuracy_m);
  EXPECT_NEAR(found.accuracy_m, 0.6 * std::sqrt(-2.0 * std::log(0.05)), 0.2);
  EXPECT_NEAR(found.position->x, expected.position->x, 0.4);
  EXPECT_NEAR(found.position->y, expected.position->y, 0.4);
}

TEST(CloudSummary, MassBesideTheAreaIsOutlierProbability) {
  const Grid grid = room_grid();
  std::vector<char> inside(grid.size());
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    inside[cell] = grid.centre(cell).x < 6.0 ? 1 : 0;
  }
  const PlaceCloud cloud = cloud_of_hills({{4.0, 3.0, 0.1, 900}, {8.0, 3.0, 0.1, 600}}, 2);
  LocationEstimate location;
  EXPECT_NEAR(summarise_cloud(cloud, grid, inside, {}, location), 0.4, 0.02);
  ASSERT_EQ(location.hypotheses.size(), 1U);
  EXPECT_NEAR(location.hypotheses.front().weight, 0.6, 0.02);
  EXPECT_NEAR(location.position->x, 4.0, 0.05);

  const PlaceCloud beside = cloud_of_hills({{8.0, 3.0, 0.1, 600}}, 2);
  LocationEstimate nowhere;
  EXPECT_EQ(summarise_cloud(beside, grid, inside, {}, nowhere), 1.0);
  EXPECT_FALSE(nowhere.position);
  EXPECT_EQ(nowhere.reason, SearchArea::kBeside);
}

TEST(CloudSummary, ImpossiblePlacesAreNotBesideTheArea) {
  PlaceCloud cloud = cloud_of_hills({{4.0, 3.0, 0.1, 20}}, 2);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.remove(i);
  }
  LocationEstimate location;
  EXPECT_EQ(summarise_cloud(cloud, room_grid(), {}, {}, location), 1.0);
  EXPECT_FALSE(location.position);
  EXPECT_EQ(location.reason, "no place of the cloud is possible");
}

TEST(CloudSummary, VelocityIsThatOfThePlacesNearby) {
  const PlaceCloud cloud =
      cloud_of_hills({{2.0, 2.0, 0.03, 500, 1.0F}, {5.0, 2.0, 0.03, 500, -0.5F}}, 2);
  EXPECT_NEAR(velocity_of(cloud, {2.0, 2.0, kHeight}).x, 1.0, 1e-5);
  EXPECT_NEAR(velocity_of(cloud, {5.0, 2.0, 0.0}).x, -0.5, 1e-5);
  EXPECT_NEAR(velocity_of(cloud, {8.0, 2.0, 0.0}).x, 0.25, 0.03);
  EXPECT_EQ(velocity_of(cloud, {2.0, 2.0, kHeight}).z, 0.0);
}

}  // namespace
}  // namespace rayloc::cloud_summary_test
