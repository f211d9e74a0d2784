#include "engine/observe/savitzky_golay.h"

#include <algorithm>
#include <string>

#include <Eigen/Dense>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Weights of the values at `position` in the value of their polynomial at `at`.
Eigen::VectorXd weights_at(std::span<const double> position, double at, Eigen::Index order) {
  const auto count = static_cast<Eigen::Index>(position.size());
  const double width = std::max(position.back() - position.front(), 1e-300);
  Eigen::MatrixXd powers(count, order + 1);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double x = (position[static_cast<std::size_t>(i)] - at) / width;
    powers(i, 0) = 1.0;
    for (Eigen::Index k = 1; k <= order; ++k) {
      powers(i, k) = powers(i, k - 1) * x;
    }
  }
  // The constant term of the solution: the first row of the pseudo-inverse, R^-1 Q^T.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(powers);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(count, order + 1);
  const Eigen::VectorXd row =
      qr.matrixQR().topRows(order + 1).triangularView<Eigen::Upper>().transpose().solve(
          Eigen::VectorXd::Unit(order + 1, 0));
  return q * row;
}

}  // namespace

Expected<void> validate(const SavitzkyGolayOptions& options) {
  if (options.window < 1 || options.window % 2 == 0) {
    return make_error(
        ErrorKind::kUsage,
        "a smoothing window has an odd number of tones, not " + std::to_string(options.window));
  }
  if (options.order < 0 || options.order >= options.window) {
    return make_error(ErrorKind::kUsage,
                      "a smoothing polynomial over " + std::to_string(options.window) +
                          " tones has an order from 0 to " + std::to_string(options.window - 1) +
                          ", not " + std::to_string(options.order));
  }
  return {};
}

SavitzkyGolay::SavitzkyGolay(std::span<const double> position,
                             const SavitzkyGolayOptions& options) {
  RAYLOC_CHECK(validate(options).has_value() && !position.empty());
  const std::size_t size = position.size();
  window_ = std::min(static_cast<std::size_t>(options.window), size);
  const auto order = std::min<Eigen::Index>(options.order, static_cast<Eigen::Index>(window_) - 1);
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t half = window_ / 2;
    const std::size_t first = std::min(i > half ? i - half : 0, size - window_);
    const Eigen::VectorXd weight = weights_at(position.subspan(first, window_), position[i], order);
    first_.push_back(first);
    coefficient_.insert(coefficient_.end(), weight.begin(), weight.end());
  }
}

std::vector<std::complex<double>> SavitzkyGolay::smooth(
    std::span<const std::complex<double>> values) const {
  RAYLOC_CHECK(values.size() == size());
  std::vector<std::complex<double>> smoothed(size());
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t j = 0; j < window_; ++j) {
      smoothed[i] += coefficient_[i * window_ + j] * values[first_[i] + j];
    }
  }
  return smoothed;
}

std::vector<std::complex<double>> SavitzkyGolay::adjoint(
    std::span<const std::complex<double>> smoothed_adjoint) const {
  RAYLOC_CHECK(smoothed_adjoint.size() == size());
  std::vector<std::complex<double>> values(size());
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t j = 0; j < window_; ++j) {
      values[first_[i] + j] += coefficient_[i * window_ + j] * smoothed_adjoint[i];
    }
  }
  return values;
}

}  // namespace rayloc
