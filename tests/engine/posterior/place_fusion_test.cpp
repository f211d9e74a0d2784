#include "engine/posterior/place_fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace rayloc::place_fusion_test {
namespace {

constexpr double kTemper = 0.4;
constexpr std::size_t kPlaces = 400;
using Values = std::vector<std::vector<float>>;

// Log-likelihoods of places of which one in ten fits, each access point by itself.
Values random_values(std::size_t arrays, float fit, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::uniform_int_distribution<int> tenth(0, 9);
  Values values(arrays);
  for (auto& one : values) {
    for (std::size_t n = 0; n < kPlaces; ++n) {
      one.push_back(-20.0F + 8.0F * normal(random) + (tenth(random) == 0 ? fit : 0.0F));
    }
  }
  return values;
}

std::vector<std::vector<double>> maps_of(const Values& values) {
  std::vector<std::vector<double>> maps;
  for (const auto& one : values) {
    maps.emplace_back(one.begin(), one.end());
  }
  return maps;
}

// Largest difference from the same in double precision.
double error_of(const Values& values) {
  const std::vector<double> faulty(values.size(), 0.015);
  const auto maps = maps_of(values);
  const AccessPointFusion fusion(maps, kTemper, faulty);
  const std::vector<float> fused = fused_log_likelihood(values, fusion, kTemper);
  double worst = 0.0;
  for (std::size_t n = 0; n < kPlaces; ++n) {
    std::vector<double> of_each;
    of_each.reserve(maps.size());
    for (const auto& map : maps) {
      of_each.push_back(map[n]);
    }
    worst =
        std::max(worst, std::abs(static_cast<double>(fused[n]) - fusion.log_likelihood(of_each)));
  }
  return worst;
}

TEST(PlaceFusion, IsThatOfAccessPointFusion) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(error_of(random_values(1, 40.0F, seed)), 1e-3);
    EXPECT_LT(error_of(random_values(2, 40.0F, seed)), 1e-3);
    EXPECT_LT(error_of(random_values(3, 40.0F, seed)), 1e-3);
  }
}

// Masses that single precision cannot represent beside the largest of each access point.
TEST(PlaceFusion, CoversContradictionsBeyondSinglePrecision) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(error_of(random_values(3, 250.0F, seed)), 5e-3);
    EXPECT_LT(error_of(random_values(8, 90.0F, seed)), 5e-3);
  }
}

// A cloud at a wrong place: no access point explains it there nearly as well as in the room.
TEST(PlaceFusion, CoversPlacesFarBelowTheMeanOfTheRoom) {
  const std::vector<AccessPointFusion::Terms> means{{90.0, 22.0, 5.0}, {20.0, 5.0, 1.0}};
  const std::vector<double> faulty(2, 0.015);
  const auto fusion = AccessPointFusion::of_means(means, kTemper, faulty);
  for (const float level : {-50.0F, -400.0F, -2000.0F, -8000.0F}) {
    const Values values{std::vector<float>(8, level), std::vector<float>(8, 0.5F * level)};
    const std::vector<double> of_each{static_cast<double>(level), 0.5 * static_cast<double>(level)};
    for (const float one : fused_log_likelihood(values, fusion, kTemper)) {
      EXPECT_NEAR(static_cast<double>(one), fusion.log_likelihood(of_each), 5e-3) << level;
    }
  }
}

TEST(PlaceFusion, APlaceThatWasNotComparedHasTheLeastValue) {
  for (const std::size_t arrays : {std::size_t{1}, std::size_t{3}}) {
    Values values = random_values(arrays, 40.0F, 1);
    const std::vector<double> faulty(arrays, 0.015);
    const AccessPointFusion fusion(maps_of(values), kTemper, faulty);
    for (auto& one : values) {
      one[17] = kNoMass;
    }
    const auto fused = fused_log_likelihood(values, fusion, kTemper);
    EXPECT_EQ(fused[17], kNoMass);
    EXPECT_GT(fused[18], kNoMass);
  }
}

TEST(PlaceFusion, MeansOverTheRoomMakeTheSameFusionAsItsMaps) {
  const auto maps = maps_of(random_values(3, 40.0F, 2));
  const std::vector<double> faulty{0.015, 0.03, 0.01};
  std::vector<AccessPointFusion::Terms> means;
  means.reserve(maps.size());
  for (const auto& map : maps) {
    means.push_back({log_mean_exp(map, kTemper),
                     log_mean_exp(map, kBlunted[0].exponent * kTemper),
                     log_mean_exp(map, kBlunted[1].exponent * kTemper)});
  }
  const AccessPointFusion of_maps(maps, kTemper, faulty);
  const AccessPointFusion of_means = AccessPointFusion::of_means(means, kTemper, faulty);
  ASSERT_EQ(of_means.size(), maps.size());
  for (std::size_t n = 0; n < kPlaces; ++n) {
    const std::vector<double> of_each{maps[0][n], maps[1][n], maps[2][n]};
    EXPECT_EQ(of_means.log_likelihood(of_each), of_maps.log_likelihood(of_each));
  }
  EXPECT_EQ(of_means.faulty(1, 3.0), of_maps.faulty(1, 3.0));
  EXPECT_EQ(of_means.outlier(2.0, 0.015), of_maps.outlier(2.0, 0.015));
}

TEST(PlaceFusion, MeanCountsPlacesThatWereNotCompared) {
  const std::vector<float> values{1.0F, 2.0F, kNoMass, 3.0F, 100.0F};
  const double mean = (std::exp(0.5) + std::exp(1.0) + std::exp(1.5)) / 4.0;
  EXPECT_NEAR(log_mean_of(values, 4, 0.5), std::log(mean), 1e-6);
  const std::vector<float> none(8, kNoMass);
  EXPECT_EQ(log_mean_of(none, 8, 0.5), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace rayloc::place_fusion_test
