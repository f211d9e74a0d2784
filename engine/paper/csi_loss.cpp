#include "engine/paper/csi_loss.h"

#include "engine/base/check.h"

namespace rayloc::paper {
namespace {

constexpr double kNanosecond = 1e-9;  // [s]

double mean_square_error(std::span<const double> measured, std::span<const double> expected) {
  RAYLOC_CHECK(measured.size() == expected.size() && !measured.empty());
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double off = expected[i] - measured[i];
    sum += off * off;
  }
  return sum / static_cast<double>(measured.size());
}

// weight * d(mean square error) / d(expected).
std::vector<double> slope(std::span<const double> measured,
                          std::span<const double> expected,
                          double weight) {
  RAYLOC_CHECK(measured.size() == expected.size() && !measured.empty());
  std::vector<double> result(expected.size());
  for (std::size_t i = 0; i < measured.size(); ++i) {
    result[i] = 2.0 * weight * (expected[i] - measured[i]) / static_cast<double>(measured.size());
  }
  return result;
}

}  // namespace

CsiLoss::CsiLoss(const OfdmGrid& grid, const CsiLossOptions& options)
    : amplitude_(grid, options.smoothing, options.floor),
      spread_(grid, options.floor),
      delay_weight_(options.delay_weight / (kNanosecond * kNanosecond)) {}

CsiLoss::Observables CsiLoss::observe(std::span<const std::complex<double>> h) const {
  return {amplitude_.of(h), spread_.of(h)};
}

double CsiLoss::value(const Observables& measured, const Observables& expected) const {
  return mean_square_error(measured.amplitude, expected.amplitude) +
         delay_weight_ * mean_square_error(measured.spread, expected.spread);
}

std::vector<std::complex<double>> CsiLoss::adjoint(const Observables& measured,
                                                   const Observables& expected,
                                                   std::span<const std::complex<double>> h) const {
  auto result = amplitude_.adjoint(h, slope(measured.amplitude, expected.amplitude, 1.0));
  const auto by_spread = spread_.adjoint(h, slope(measured.spread, expected.spread, delay_weight_));
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] += by_spread[i];
  }
  return result;
}

}  // namespace rayloc::paper
