#include "engine/posterior/access_point_fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayloc {
namespace {

constexpr double kTemper = 0.8;
using Maps = std::vector<std::vector<double>>;

// 100 cells, of which one stands out by `height`.
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

TEST(AccessPointFusion, OneIsBelievedAsItIs) {
  const Maps maps{peak_at(7, 5.0)};
  const std::vector<double> faulty{0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  for (std::size_t cell = 0; cell < map.size(); ++cell) {
    EXPECT_NEAR(map[cell] - map[0], maps[0][cell], 1e-9);
  }
  // Whatever it says, one burst in fifty says nothing.
  EXPECT_NEAR(fusion.elsewhere(log_mean_exp(map, kTemper), 0.01), 0.02, 2e-4);
}

TEST(AccessPointFusion, ThoseThatAgreeAddUp) {
  const Maps maps{peak_at(7, 6.0), peak_at(7, 6.0)};
  const std::vector<double> faulty{0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_NEAR(map[7] - map[0], 12.0, 0.1);
  EXPECT_LT(fusion.elsewhere(log_mean_exp(map, kTemper), 0.01), 0.01);
  EXPECT_LT(fusion.faulty(0, 6.0), 1e-3);
}

TEST(AccessPointFusion, OneAgainstTwoIsOutvotedHoweverSureItIs) {
  const Maps maps{peak_at(7, 20.0), peak_at(7, 20.0), peak_at(60, 80.0)};
  const std::vector<double> faulty{0.01, 0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_GT(probability(map, 7), 0.95);
  EXPECT_GT(fusion.faulty(2, maps[2][7]), 0.99);
  EXPECT_LT(fusion.faulty(0, maps[0][7]), 0.01);
  EXPECT_LT(fusion.elsewhere(log_mean_exp(map, kTemper), 0.01), 0.05);
}

TEST(AccessPointFusion, TwoThatContradictEachOtherLeaveBothPlacesAndElsewhere) {
  const Maps maps{peak_at(7, 60.0), peak_at(60, 80.0)};
  const std::vector<double> faulty{0.01, 0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_NEAR(probability(map, 7), 0.5, 0.01);
  EXPECT_NEAR(probability(map, 60), 0.5, 0.01);
  const double elsewhere = fusion.elsewhere(log_mean_exp(map, kTemper), 0.01);
  EXPECT_GT(elsewhere, 0.3);
  EXPECT_LT(elsewhere, 0.4);  // 0.01 against twice 0.01 (1 - 0.01)
}

TEST(AccessPointFusion, CellsThatWereNotLookedAtHaveNoMass) {
  Maps maps{std::vector<double>(100, -1e4)};
  maps[0][7] = 3.0;
  const std::vector<double> faulty{0.01};
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const auto map = fused(maps, fusion);
  EXPECT_EQ(map[0], AccessPointFusion::kNothing);
  EXPECT_DOUBLE_EQ(probability(map, 7), 1.0);
}

}  // namespace
}  // namespace rayloc
