#include "engine/grid/height_layers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rayloc {
namespace {

constexpr double kReach = 2.25;     // standard deviations to either side: 97.6 % of the prior
constexpr double kThickest = 0.15;  // [m], chosen: a path's direction is the same across a layer
constexpr double kMinAbove = 0.1;   // [m], chosen: clearance to floor and ceiling

// Probability of a standard normal variable below x.
double below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

// Probability that a normal variable of mean 0 is between these values.
double between(double low, double high, double sigma) {
  return below(high / sigma) - below(low / sigma);
}

}  // namespace

HeightLayers height_layers(const HeightPrior& prior, double floor, double ceiling) {
  if (prior.sigma <= 0.0) {
    return {};
  }
  const double reach = kReach * prior.sigma;
  const double low = std::max(-reach, std::min(floor + kMinAbove - prior.mean, 0.0));
  const double high = std::min(reach, std::max(ceiling - kMinAbove - prior.mean, 0.0));
  const auto count = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil((high - low) / kThickest - 1e-9)));
  HeightLayers layers{{}, {}, 0.0};
  layers.thickness = (high - low) / static_cast<double>(count);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double from = low + layers.thickness * static_cast<double>(i);
    layers.offset.push_back(from + 0.5 * layers.thickness);
    layers.weight.push_back(between(from, from + layers.thickness, prior.sigma));
    sum += layers.weight.back();
  }
  for (double& weight : layers.weight) {
    weight /= sum;
  }
  return layers;
}

std::vector<double> layer_probabilities(const HeightLayers& layers, double mean, double sigma) {
  std::vector<double> result;
  result.reserve(layers.size());
  for (const double offset : layers.offset) {
    const double from = offset - 0.5 * layers.thickness - mean;
    result.push_back(between(from, from + layers.thickness, sigma));
  }
  return result;
}

std::vector<HeightSlice> slices_of(const HeightLayers& layers,
                                   std::size_t layer,
                                   double sigma,
                                   double most) {
  if (layers.is_known()) {
    return {{layers.offset[layer], 1.0}};
  }
  const auto count =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(layers.thickness / most)));
  const double step = layers.thickness / static_cast<double>(count);
  std::vector<HeightSlice> slices;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double offset = layers.offset[layer] +
                          step * (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1));
    const double z = offset / sigma;
    slices.push_back({offset, std::exp(-0.5 * z * z)});
    sum += slices.back().weight;
  }
  for (HeightSlice& slice : slices) {
    slice.weight /= sum;
  }
  return slices;
}

}  // namespace rayloc
