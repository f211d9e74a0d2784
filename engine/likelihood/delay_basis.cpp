#include "engine/likelihood/delay_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "engine/base/check.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kWindowBegin = -12e-9;  // [s]
constexpr double kWindowEnd = 75e-9;     // [s], METHODS B2
constexpr double kWindowStep = 0.5e-9;   // [s], chosen: finer than 160 MHz resolves
constexpr double kBasisLeftOut = 1e-4;   // share of the window's power outside the basis
// Linear interpolation at this step is exact to 4e-5 over 80 MHz.
constexpr double kTableStep = 0.05e-9;
constexpr std::size_t kTableSize =
    2400;  // a count, chosen: 120 ns; later tones are computed exactly

}  // namespace

DelaySearch first_delay_search(const OfdmGrid& grid) {
  const double band = grid.spacing_hz * (grid.tone_index.back() - grid.tone_index.front());
  const auto count = static_cast<std::size_t>(std::ceil(2.0 * band / grid.spacing_hz));
  return {1.0 / (grid.spacing_hz * static_cast<double>(count)), count};
}

DelayBasis::DelayBasis(const OfdmGrid& grid) {
  RAYLOC_CHECK(grid.size() >= 2);
  const auto tones = static_cast<Eigen::Index>(grid.size());
  for (std::size_t k = 0; k < grid.size(); ++k) {
    angular_offset_.push_back(2.0 * std::numbers::pi * grid.offset_hz(k));
  }
  const auto delays =
      static_cast<Eigen::Index>(std::lround((kWindowEnd - kWindowBegin) / kWindowStep) + 1);
  Eigen::MatrixXcd window(tones, delays);
  const double scale = 1.0 / std::sqrt(static_cast<double>(tones));
  for (Eigen::Index t = 0; t < delays; ++t) {
    const double delay = kWindowBegin + kWindowStep * static_cast<double>(t);
    for (Eigen::Index k = 0; k < tones; ++k) {
      window(k, t) = std::polar(scale, -angular_offset_[static_cast<std::size_t>(k)] * delay);
    }
  }
  // The left singular vectors of the window, as eigenvectors of its Gram matrix: the neglected
  // power is far above the square root of the rounding error, and it compiles four times faster.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> gram(window * window.adjoint());
  RAYLOC_CHECK(gram.info() == Eigen::Success);
  const Eigen::VectorXd power = gram.eigenvalues().reverse();  // largest first
  double left = power.sum();
  const double most_left = kBasisLeftOut * left;
  while (static_cast<Eigen::Index>(size_) < power.size() && left > most_left) {
    left -= power(static_cast<Eigen::Index>(size_++));
  }
  for (std::size_t q = 0; q < size_; ++q) {
    for (Eigen::Index k = 0; k < tones; ++k) {
      basis_.push_back(gram.eigenvectors()(k, tones - 1 - static_cast<Eigen::Index>(q)));
    }
  }
  table_.resize(kTableSize * size_);
  for (std::size_t i = 0; i < kTableSize; ++i) {
    exact_tone(kTableStep * static_cast<double>(i), {table_.data() + i * size_, size_});
  }
}

void DelayBasis::exact_tone(double delay, std::span<Value> out) const {
  const std::size_t tones = angular_offset_.size();
  const double scale = 1.0 / std::sqrt(static_cast<double>(tones));
  std::vector<Value> tone(tones);
  for (std::size_t k = 0; k < tones; ++k) {
    tone[k] = std::polar(scale, -angular_offset_[k] * delay);
  }
  project(tone, out);
}

void DelayBasis::tone(double delay, std::span<Value> out) const {
  const double position = delay / kTableStep;
  if (position < 0.0 || position >= static_cast<double>(kTableSize - 1)) {
    exact_tone(delay, out);
    return;
  }
  const auto i = static_cast<std::size_t>(position);
  const double share = position - static_cast<double>(i);
  for (std::size_t q = 0; q < size_; ++q) {
    out[q] = (1.0 - share) * table_[i * size_ + q] + share * table_[(i + 1) * size_ + q];
  }
}

void DelayBasis::project(std::span<const Value> value, std::span<Value> out) const {
  const std::size_t tones = angular_offset_.size();
  for (std::size_t q = 0; q < size_; ++q) {
    const Value* basis = basis_.data() + q * tones;
    double re = 0.0;
    double im = 0.0;
    for (std::size_t k = 0; k < tones; ++k) {
      re += basis[k].real() * value[k].real() + basis[k].imag() * value[k].imag();
      im += basis[k].real() * value[k].imag() - basis[k].imag() * value[k].real();
    }
    out[q] = {re, im};
  }
}

std::vector<Value> DelayBasis::diffuse_covariance(double decay) const {
  constexpr double kStep = 0.5e-9;  // [s], chosen: a small share of any decay of a room
  std::vector<Value> covariance(size_ * size_);
  std::vector<Value> s(size_);
  double total = 0.0;
  const auto steps = static_cast<std::size_t>(8.0 * decay / kStep);
  for (std::size_t step = 0; step < steps; ++step) {
    const double delay = kStep * static_cast<double>(step);
    const double weight = std::exp(-delay / decay);
    total += weight;
    tone(delay, s);
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j < size_; ++j) {
        covariance[i * size_ + j] += weight * s[i] * std::conj(s[j]);
      }
    }
  }
  for (Value& value : covariance) {
    value /= total;
  }
  return covariance;
}

}  // namespace rayloc
