#include "engine/track/layer_weights.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rayloc {

LayerMass layer_mass_of(const RefinedCells& within,
                        const std::vector<double>& mass,
                        const CellWindow& window,
                        const Grid& grid) {
  LayerMass layers{std::vector<double>(grid.layers.size()), 0.0};
  for (const auto& [cell, of_cell] : within) {
    const auto number = window.number(cell, grid);
    if (!number) {
      continue;
    }
    for (std::size_t layer = 0; layer < layers.of_layer.size(); ++layer) {
      layers.of_layer[layer] += mass[*number] * static_cast<double>(of_cell.layers[layer]);
    }
    layers.known += mass[*number];
  }
  return layers;
}

void LayerWeights::learn(const HeightLayers& heights, const LayerMass& mass, double weight) {
  if (weights_.empty()) {
    weights_ = heights.weight;
  }
  double sum = 0.0;
  for (std::size_t layer = 0; layer < weights_.size(); ++layer) {
    // Cells that were not evaluated carry no information on the height.
    const double all = mass.of_layer[layer] + std::max(0.0, 1.0 - mass.known) * weights_[layer];
    weights_[layer] = std::pow(weights_[layer], 1.0 - weight) * std::pow(all, weight);
    sum += weights_[layer];
  }
  for (double& layer : weights_) {
    layer /= sum;
  }
}

void LayerWeights::spread(const HeightLayers& heights, const Motion& motion, double seconds) {
  if (weights_.empty()) {
    return;
  }
  const double steps = motion.speed * seconds / heights.thickness;
  const double variance = std::min(0.5, steps * steps);
  const double anew = 1.0 - std::exp(-motion.change_rate * seconds);
  std::vector<double> spread(weights_.size());
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    const std::size_t low = i > 0 ? i - 1 : i;
    const std::size_t high = i + 1 < weights_.size() ? i + 1 : i;
    spread[low] += 0.5 * variance * weights_[i];
    spread[high] += 0.5 * variance * weights_[i];
    spread[i] += (1.0 - variance) * weights_[i];
  }
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] = (1.0 - anew) * spread[i] + anew * heights.weight[i];
  }
}

}  // namespace rayloc
