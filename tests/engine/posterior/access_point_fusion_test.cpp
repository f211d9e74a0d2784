#include "engine/posterior/access_point_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace rayloc::access_point_fusion_test {
namespace {

constexpr double kTemper = 0.8;
using Maps = std::vector<std::vector<double>>;

// 100 cells, one of which is higher by `height`.
std::vector<double> peak_at(std::size_t cell, double height) {
  std::vector<double> map(100, 0.0);
  map[cell] = height;
  return map;
}

std::vector<double> fused(const Maps& maps, const AccessPointFusion& fusion) {
  std::vector<double> map;
  for (std::size_t cell = 0; cell < maps.front().size(); ++cell) {
    std::vector<double> of_each;
    for (const auto& one : maps) {
      of_each.push_back(one[cell]);
    }
    map.push_back(fusion.log_likelihood(of_each));
  }
  return map;
}

double probability(const std::vector<double>& map, std::size_t cell) {
  return std::exp(kTemper * map[cell] - log_mean_exp(map, kTemper)) / 100.0;
}

TEST(AccessPointFusion, ASingleMapIsUnchanged) {
  const Maps maps{peak_at(7, 5.0)};
  const std::vector<double> faulty{0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  for (std::size_t cell = 0; cell < map.size(); ++cell) {
    EXPECT_NEAR(map[cell] - map[0], maps[0][cell], 1e-9);
  }
  // For any map, one burst in fifty carries no information.
  EXPECT_NEAR(fusion.outlier(log_mean_exp(map, kTemper), 0.01), 0.02, 2e-4);
}

TEST(AccessPointFusion, AgreeingMapsAddUp) {
  const Maps maps{peak_at(7, 6.0), peak_at(7, 6.0)};
  const std::vector<double> faulty{0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  // Each adds its own 6 nats, less the share of a blunted access point.
  EXPECT_NEAR(map[7] - map[0], 12.0, 3.0);
  EXPECT_LT(fusion.outlier(log_mean_exp(map, kTemper), 0.01), 0.01);
  EXPECT_LT(fusion.faulty(0, 6.0), 0.02);  // mostly blunted
}

TEST(AccessPointFusion, TwoMapsOutvoteAContradictingThird) {
  const Maps maps{peak_at(7, 20.0), peak_at(7, 20.0), peak_at(60, 80.0)};
  const std::vector<double> faulty{0.01, 0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_GT(probability(map, 7), 0.95);
  EXPECT_GT(fusion.faulty(2, maps[2][7]), 0.99);
  EXPECT_LT(fusion.faulty(0, maps[0][7]), 0.02);
  EXPECT_LT(fusion.outlier(log_mean_exp(map, kTemper), 0.01), 0.05);
}

TEST(AccessPointFusion, TwoContradictingMapsKeepBothPlacesAndRaiseTheOutlier) {
  const Maps maps{peak_at(7, 60.0), peak_at(60, 80.0)};
  const std::vector<double> faulty{0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_GT(probability(map, 7), 0.3);
  EXPECT_GT(probability(map, 60), 0.3);
  const double outlier = fusion.outlier(log_mean_exp(map, kTemper), 0.01);
  EXPECT_GT(outlier, 0.02);  // more than before any burst
}

// A hill of a standard deviation of `width` cells.
std::vector<double> hill_at(double cell, double width) {
  std::vector<double> map(100);
  for (std::size_t n = 0; n < map.size(); ++n) {
    const double away = (static_cast<double>(n) - cell) / width;
    map[n] = -0.5 * away * away / kTemper;
  }
  return map;
}

// Mean and standard deviation of the fused map's mass, in cells.
std::pair<double, double> mass_of(const Maps& maps) {
  const std::vector<double> faulty(maps.size(), 0.015);
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  double mean = 0.0;
  double square = 0.0;
  for (std::size_t n = 0; n < map.size(); ++n) {
    const auto cell = static_cast<double>(n);
    mean += probability(map, n) * cell;
    square += probability(map, n) * cell * cell;
  }
  return {mean, std::sqrt(square - mean * mean)};
}

TEST(AccessPointFusion, AgreeingMapsAreBarelyWidened) {
  const auto [mean, sigma] = mass_of({hill_at(50, 3), hill_at(50, 3), hill_at(50, 3)});
  EXPECT_NEAR(mean, 50.0, 0.01);
  EXPECT_GT(sigma, 3.0 / std::sqrt(3.0));
  EXPECT_LT(sigma, 1.7 * 3.0 / std::sqrt(3.0));
}

TEST(AccessPointFusion, SlightlyContradictingMapsAreWidened) {
  // Bumped: they are four standard deviations apart.
  const auto [mean, sigma] = mass_of({hill_at(38, 3), hill_at(50, 3), hill_at(62, 3)});
  EXPECT_NEAR(mean, 50.0, 0.1);
  EXPECT_GT(sigma, 5.0);  // unwidened: 1.7
  // The place between two holds although it is off by twice what each states.
  const auto [two, wide] = mass_of({hill_at(44, 3), hill_at(56, 3)});
  EXPECT_NEAR(two, 50.0, 0.1);
  EXPECT_GT(wide, 4.0);  // unwidened: 2.1
}

TEST(AccessPointFusion, UnevaluatedCellsHaveNoMass) {
  Maps maps{std::vector<double>(100, -1e4)};
  maps[0][7] = 3.0;
  const std::vector<double> faulty{0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_EQ(map[0], AccessPointFusion::kNothing);
  EXPECT_DOUBLE_EQ(probability(map, 7), 1.0);
}

}  // namespace
}  // namespace rayloc::access_point_fusion_test
