#include "engine/observe/csi_ratio.h"

#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

double mean_square(std::span<const Value> row) {
  double sum = 0.0;
  for (const Value& v : row) {
    sum += std::norm(v);
  }
  return sum / static_cast<double>(row.size());
}

std::vector<double> tone_numbers(const OfdmGrid& grid) {
  return {grid.tone_index.begin(), grid.tone_index.end()};
}

}  // namespace

std::vector<Value> csi_ratio(std::span<const Value> h, std::size_t tones, double floor) {
  RAYLOC_CHECK(tones > 0 && h.size() % tones == 0 && floor > 0.0);
  std::vector<Value> ratio;
  for (std::size_t row = 0; row + tones < h.size(); row += tones) {
    const auto numerator = h.subspan(row, tones);
    const auto denominator = h.subspan(row + tones, tones);
    const double least = floor * mean_square(denominator);
    for (std::size_t k = 0; k < tones; ++k) {
      const double q = std::norm(denominator[k]) + least;
      ratio.push_back(q > 0.0 ? numerator[k] * std::conj(denominator[k]) / q : Value());
    }
  }
  return ratio;
}

std::vector<Value> csi_ratio_adjoint(std::span<const Value> h,
                                     std::size_t tones,
                                     double floor,
                                     std::span<const Value> ratio_adjoint) {
  RAYLOC_CHECK(tones > 0 && h.size() % tones == 0 && floor > 0.0);
  RAYLOC_CHECK(ratio_adjoint.size() + tones == h.size() || h.empty());
  std::vector<Value> adjoint(h.size());
  for (std::size_t row = 0; row + tones < h.size(); row += tones) {
    const auto numerator = h.subspan(row, tones);
    const auto denominator = h.subspan(row + tones, tones);
    const double least = floor * mean_square(denominator);
    double by_least = 0.0;  // dL / d(least)
    for (std::size_t k = 0; k < tones; ++k) {
      const double q = std::norm(denominator[k]) + least;
      if (q <= 0.0) {
        continue;
      }
      // dr = (dn conj(d) + n conj(dd) - r dq) / q, dq = 2 Re(conj(d) dd) + d(least).
      const Value g = ratio_adjoint[row + k];
      const Value ratio = numerator[k] * std::conj(denominator[k]) / q;
      const double by_q = -(std::conj(g) * ratio).real() / q;
      adjoint[row + k] += g * denominator[k] / q;
      adjoint[row + tones + k] += std::conj(g) * numerator[k] / q + 2.0 * by_q * denominator[k];
      by_least += by_q;
    }
    const double by_square = floor * by_least / static_cast<double>(tones);
    for (std::size_t k = 0; k < tones; ++k) {
      adjoint[row + tones + k] += 2.0 * by_square * denominator[k];
    }
  }
  return adjoint;
}

RatioAmplitude::RatioAmplitude(const OfdmGrid& grid,
                               const SavitzkyGolayOptions& smoothing,
                               double floor)
    : smoother_(tone_numbers(grid), smoothing), floor_(floor) {}

std::vector<Value> RatioAmplitude::smoothed(std::span<const Value> h) const {
  const std::size_t tones = smoother_.size();
  const auto ratio = csi_ratio(h, tones, floor_);
  std::vector<Value> result;
  for (std::size_t row = 0; row < ratio.size(); row += tones) {
    const auto smooth = smoother_.smooth(std::span(ratio).subspan(row, tones));
    result.insert(result.end(), smooth.begin(), smooth.end());
  }
  return result;
}

std::vector<double> RatioAmplitude::of(std::span<const Value> h) const {
  std::vector<double> amplitude;
  for (const Value& value : smoothed(h)) {
    amplitude.push_back(std::abs(value));
  }
  return amplitude;
}

std::vector<Value> RatioAmplitude::adjoint(std::span<const Value> h,
                                           std::span<const double> amplitude_adjoint) const {
  const auto ratio = smoothed(h);
  RAYLOC_CHECK(amplitude_adjoint.size() == ratio.size());
  const std::size_t tones = smoother_.size();
  std::vector<Value> by_ratio;
  std::vector<Value> by_smoothed(tones);
  for (std::size_t row = 0; row < ratio.size(); row += tones) {
    for (std::size_t k = 0; k < tones; ++k) {
      const double amplitude = std::abs(ratio[row + k]);
      by_smoothed[k] =
          amplitude > 0.0 ? amplitude_adjoint[row + k] * ratio[row + k] / amplitude : Value();
    }
    const auto back = smoother_.adjoint(by_smoothed);
    by_ratio.insert(by_ratio.end(), back.begin(), back.end());
  }
  return csi_ratio_adjoint(h, tones, floor_, by_ratio);
}

}  // namespace rayloc
