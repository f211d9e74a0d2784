#include "engine/grid/height_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace rayloc::height_layers_test {
namespace {

constexpr double kSigma = 0.3;

TEST(HeightLayers, AreOneLayerWhereTheHeightIsKnown) {
  const HeightLayers layers = height_layers({1.2, 0.0}, 0.0, 2.5);
  EXPECT_TRUE(layers.is_known());
  EXPECT_EQ(layers.offset, std::vector<double>{0.0});
  EXPECT_EQ(layers.weight, std::vector<double>{1.0});
}

TEST(HeightLayers, FollowThePriorAndStayInTheRoom) {
  HeightPrior prior{1.2, kSigma};
  const HeightLayers layers = height_layers(prior, 0.0, 2.5);
  EXPECT_GE(layers.size(), 9U);
  EXPECT_NEAR(std::accumulate(layers.weight.begin(), layers.weight.end(), 0.0), 1.0, 1e-12);
  double variance = 0.0;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    EXPECT_NEAR(layers.weight[i], layers.weight[layers.size() - 1 - i], 1e-12);
    variance += layers.weight[i] * layers.offset[i] * layers.offset[i];
  }
  EXPECT_NEAR(std::sqrt(variance), kSigma, 0.1 * kSigma);  // its tails are cut off
  prior.mean = 0.3;
  const HeightLayers low = height_layers(prior, 0.0, 2.5);
  EXPECT_GE(prior.mean + low.offset.front() - 0.5 * low.thickness, 0.0);
  EXPECT_LE(low.thickness, layers.thickness + 0.05);
}

TEST(HeightLayers, HaveTheProbabilitiesOfAHeight) {
  const HeightLayers layers = height_layers({1.2, kSigma}, 0.0, 2.5);
  const std::vector<double> prior = layer_probabilities(layers, 0.0, kSigma);
  const double sum = std::accumulate(prior.begin(), prior.end(), 0.0);
  ASSERT_EQ(prior.size(), layers.size());
  for (std::size_t i = 0; i < prior.size(); ++i) {
    EXPECT_NEAR(prior[i] / sum, layers.weight[i], 1e-12);
  }
  EXPECT_NEAR(layer_probabilities(layers, layers.offset[2], 1e-6)[2], 1.0, 1e-12);
}

TEST(HeightLayers, SlicesFillALayer) {
  const HeightLayers layers = height_layers({1.2, kSigma}, 0.0, 2.5);
  const auto slices = slices_of(layers, 0, kSigma, 0.015);
  double sum = 0.0;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    sum += slices[i].weight;
    if (i > 0) {
      EXPECT_LE(slices[i].offset - slices[i - 1].offset, 0.015 + 1e-12);
      EXPECT_GT(slices[i].weight, slices[i - 1].weight);  // the lowest layer, below the mean
    }
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(slices.front().offset - 0.5 * (slices[1].offset - slices[0].offset),
              layers.offset[0] - 0.5 * layers.thickness,
              1e-12);
}

}  // namespace
}  // namespace rayloc::height_layers_test
