#include "engine/em/cylinder_table.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Weights of five neighbouring samples for the slope at the first, second, middle ... of them.
constexpr std::array<std::array<double, 5>, 5> kDifferences{{
    {-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25},
    {-0.25, -5.0 / 6.0, 1.5, -0.5, 1.0 / 12.0},
    {1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0},
    {-1.0 / 12.0, 0.5, -1.5, 5.0 / 6.0, 0.25},
    {0.25, -4.0 / 3.0, 3.0, -4.0, 25.0 / 12.0},
}};

}  // namespace

ElevationTable::ElevationTable(double lowest, std::vector<std::vector<Complex<double>>> samples)
    : lowest_(lowest), count_(samples.size()) {
  RAYLOC_CHECK(count_ >= 5 && lowest > 0.0 && lowest < 1.0);
  step_ = (1.0 - lowest) / static_cast<double>(count_ - 1);
  width_ = samples.front().size();
  nodes_.resize(2 * width_ * count_);
  for (std::size_t i = 0; i < count_; ++i) {
    RAYLOC_CHECK(samples[i].size() == width_);
    const std::size_t first = i < 2 ? 0 : std::min(i - 2, count_ - 5);
    const auto& weights = kDifferences[i - first];
    Complex<double>* node = &nodes_[2 * width_ * i];
    for (std::size_t k = 0; k < width_; ++k) {
      node[k] = samples[i][k];
      Complex<double> slope;
      for (std::size_t j = 0; j < weights.size(); ++j) {
        slope = slope + Complex<double>{weights[j], 0.0} * samples[first + j][k];
      }
      node[width_ + k] = slope;
    }
  }
}

ElevationTable::Place ElevationTable::at(double cosine) const {
  const double position = (cosine - lowest_) / step_;
  const auto last = static_cast<double>(count_ - 1);
  const bool inside = position >= 0.0 && position <= last;
  const double clamped = std::clamp(position, 0.0, last);
  const auto i = static_cast<std::size_t>(std::min(clamped, last - 1.0));
  const double t = clamped - static_cast<double>(i);
  const double u = 1.0 - t;
  const double per_step = inside ? 1.0 / step_ : 0.0;
  const Complex<double>* node = &nodes_[2 * width_ * i];
  return {{node, node + width_, node + 2 * width_, node + 3 * width_},
          {u * u * (1.0 + 2.0 * t), t * u * u, t * t * (3.0 - 2.0 * t), -t * t * u},
          {-6.0 * t * u * per_step,
           (1.0 - 4.0 * t + 3.0 * t * t) * per_step,
           6.0 * t * u * per_step,
           (3.0 * t * t - 2.0 * t) * per_step}};
}

void ElevationTable::read(const Place& place,
                          std::size_t first,
                          std::span<Complex<double>> values,
                          std::span<Complex<double>> slopes) {
  const auto sum = [&](std::size_t k, const std::array<double, 4>& weight) {
    Complex<double> value;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const Complex<double>& node = place.node[i][first + k];
      value = {value.re + weight[i] * node.re, value.im + weight[i] * node.im};
    }
    return value;
  };
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = sum(k, place.weight);
  }
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    slopes[k] = sum(k, place.slope_weight);
  }
}

}  // namespace rayloc
