#include "engine/track/layer_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace rayloc::layer_weights_test {
namespace {

constexpr LayerWeights::Motion kMotion{0.1, 0.05};

Grid room() {
  Grid grid({0, 0, 0}, {1, 1, 2.5}, 1.2, 0.1);
  grid.height_sigma = 0.3;
  grid.layers = height_layers({1.2, 0.3}, 0.0, 2.5);
  return grid;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

CellMass in_layer(const Grid& grid, std::size_t layer) {
  CellMass cell;
  cell.layers.assign(grid.layers.size(), 0.0F);
  cell.layers[layer] = 1.0F;
  return cell;
}

// With the weight of a whole burst they are its mass; with half of it, the geometric mean.
TEST(LayerWeights, LearnFromTheLayersOfTheCells) {
  const Grid grid = room();
  LayerMass mass{std::vector<double>(grid.layers.size()), 1.0};
  mass.of_layer[2] = 0.75;
  mass.of_layer[3] = 0.25;
  LayerWeights layers;
  layers.learn(grid.layers, mass, 1.0);
  EXPECT_NEAR(layers.weights()[2], 0.75, 1e-12);
  EXPECT_NEAR(layers.weights()[3], 0.25, 1e-12);
  EXPECT_EQ(layers.weights()[4], 0.0);

  LayerWeights half;
  half.learn(grid.layers, mass, 0.5);
  EXPECT_NEAR(sum_of(half.weights()), 1.0, 1e-12);
  EXPECT_NEAR(half.weights()[2] / half.weights()[3],
              std::sqrt(3.0 * grid.layers.weight[2] / grid.layers.weight[3]),
              1e-12);
}

TEST(LayerWeights, CellsThatWereNotEvaluatedDoNotCount) {
  const Grid grid = room();
  LayerWeights layers;
  layers.learn(grid.layers, {std::vector<double>(grid.layers.size()), 0.0}, 0.7);
  for (std::size_t i = 0; i < grid.layers.size(); ++i) {
    EXPECT_NEAR(layers.weights()[i], grid.layers.weight[i], 1e-12);
  }
}

TEST(LayerWeights, MassOfLayersIsThatOfTheWindow) {
  const Grid grid = room();
  const CellWindow window{2, 2, 4, 4};
  std::vector<double> mass(window.size());
  const std::size_t inside = window.cell(1, grid);
  mass[1] = 0.4;
  mass[0] = 0.6;
  const RefinedCells within{{0, in_layer(grid, 1)}, {inside, in_layer(grid, 2)}};
  const LayerMass layers = layer_mass_of(within, mass, window, grid);
  EXPECT_DOUBLE_EQ(layers.known, 0.4);
  EXPECT_EQ(layers.of_layer[1], 0.0);
  EXPECT_DOUBLE_EQ(layers.of_layer[2], 0.4);
}

TEST(LayerWeights, SpreadToTheNeighboursAndReturnToThePrior) {
  const Grid grid = room();
  std::vector<double> one(grid.layers.size(), 0.0);
  one[2] = 1.0;
  LayerWeights layers;
  layers.spread(grid.layers, kMotion, 1.0);
  EXPECT_TRUE(layers.weights().empty());
  layers.set(one);
  layers.spread(grid.layers, kMotion, 0.1);
  EXPECT_NEAR(sum_of(layers.weights()), 1.0, 1e-12);
  EXPECT_GT(layers.weights()[2], 0.9);
  EXPECT_GT(layers.weights()[1], 0.0);
  for (int i = 0; i < 200; ++i) {
    layers.spread(grid.layers, kMotion, 1.0);
  }
  EXPECT_NEAR(sum_of(layers.weights()), 1.0, 1e-9);
  EXPECT_LT(layers.weights()[2], 0.9);
  layers.spread(grid.layers, kMotion, 1e4);
  for (std::size_t i = 0; i < grid.layers.size(); ++i) {
    EXPECT_NEAR(layers.weights()[i], grid.layers.weight[i], 1e-9);
  }
  layers.forget();
  EXPECT_TRUE(layers.weights().empty());
}

}  // namespace
}  // namespace rayloc::layer_weights_test
