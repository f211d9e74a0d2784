#include "engine/observe/alignment.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

// Delays tried before the refinement: this many per resolution cell 1 / bandwidth.
constexpr int kOversampling = 4;
// A count, chosen: Newton's steps double the digits of a coarse delay.
constexpr int kNewtonSteps = 4;

// In place, radix 2; twiddle[i] = exp(+j 2 pi i / n).
void inverse_transform(std::vector<Value>& data, const std::vector<Value>& twiddle) {
  const std::size_t n = data.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) {
      j ^= bit;
    }
    j ^= bit;
    if (i < j) {
      std::swap(data[i], data[j]);
    }
  }
  for (std::size_t length = 2; length <= n; length <<= 1U) {
    const std::size_t stride = n / length;
    for (std::size_t start = 0; start < n; start += length) {
      for (std::size_t i = 0; i < length / 2; ++i) {
        const Value a = data[start + i];
        const Value w = twiddle[i * stride];
        const Value b = data[start + i + length / 2];
        const Value bw(b.real() * w.real() - b.imag() * w.imag(),
                       b.real() * w.imag() + b.imag() * w.real());
        data[start + i] = a + bw;
        data[start + i + length / 2] = a - bw;
      }
    }
  }
}

double power(std::span<const Value> values) {
  double sum = 0.0;
  for (const Value& v : values) {
    sum += std::norm(v);
  }
  return sum;
}

}  // namespace

Aligner::Aligner(const OfdmGrid& grid) {
  RAYLOC_CHECK(grid.size() >= 2);
  const double middle =
      0.5 * (grid.tone_index.front() + grid.tone_index.back());  // conditions the Newton steps
  for (std::size_t k = 0; k < grid.size(); ++k) {
    angular_offset_.push_back(2.0 * std::numbers::pi * grid.spacing_hz *
                              (grid.tone_index[k] - middle));
    bin_.push_back(grid.tone_index[k] - grid.tone_index.front());
  }
  std::size_t size = 64;
  while (size < static_cast<std::size_t>(kOversampling) * static_cast<std::size_t>(bin_.back())) {
    size <<= 1U;
  }
  bin_delay_ = 1.0 / (static_cast<double>(size) * grid.spacing_hz);
  for (std::size_t i = 0; i < size; ++i) {
    twiddle_.push_back(std::polar(
        1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(size)));
  }
}

double Aligner::coarse_delay(std::span<const Value> cross) const {
  std::vector<Value> data(twiddle_.size());
  for (std::size_t k = 0; k < cross.size(); ++k) {
    data[static_cast<std::size_t>(bin_[k])] = cross[k];
  }
  inverse_transform(data, twiddle_);
  std::size_t best = 0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    if (std::norm(data[i]) > std::norm(data[best])) {
      best = i;
    }
  }
  const auto n = static_cast<double>(data.size());
  const auto i = static_cast<double>(best);
  return bin_delay_ * (i > n / 2 ? i - n : i);
}

Alignment Aligner::align(std::span<const Value> reference, std::span<const Value> value) const {
  const std::size_t tones = angular_offset_.size();
  RAYLOC_CHECK(reference.size() == value.size() && reference.size() % tones == 0);
  std::vector<Value> cross(tones);
  for (std::size_t i = 0; i < value.size(); ++i) {
    cross[i % tones] += value[i] * std::conj(reference[i]);
  }
  Alignment result;
  result.delay = coarse_delay(cross);
  // Newton on P(delay) = |S|^2 with S = sum cross exp(+j w delay).
  Value sum;
  for (int step = 0; step <= kNewtonSteps; ++step) {
    sum = {};
    Value first;
    Value second;
    for (std::size_t k = 0; k < tones; ++k) {
      const double w = angular_offset_[k];
      const Value term = cross[k] * std::polar(1.0, w * result.delay);
      sum += term;
      first += Value(0.0, w) * term;
      second -= w * w * term;
    }
    const double slope = 2.0 * (std::conj(sum) * first).real();
    const double curvature = 2.0 * (std::norm(first) + (std::conj(sum) * second).real());
    if (step == kNewtonSteps || curvature >= 0.0) {
      break;
    }
    const double change = -slope / curvature;
    result.delay += std::abs(change) < bin_delay_ ? change : std::copysign(bin_delay_, change);
  }
  const double value_power = power(value);
  const double reference_power = power(reference);
  if (value_power > 0.0 && reference_power > 0.0) {
    result.factor = std::conj(sum) / value_power;
    result.correlation = std::norm(sum) / (value_power * reference_power);
  }
  return result;
}

void Aligner::apply(const Alignment& alignment, std::span<Value> value) const {
  const std::size_t tones = angular_offset_.size();
  for (std::size_t k = 0; k < tones; ++k) {
    const Value rotation = alignment.factor * std::polar(1.0, angular_offset_[k] * alignment.delay);
    for (std::size_t i = k; i < value.size(); i += tones) {
      value[i] *= rotation;
    }
  }
}

}  // namespace rayloc
