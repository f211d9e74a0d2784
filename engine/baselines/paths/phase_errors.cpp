#include "engine/baselines/paths/phase_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace rayloc {
namespace {

constexpr std::size_t kLeast = 10;  // errors, a count, chosen
constexpr int kRounds = 500;  // of expectation maximisation, a count: it converges far earlier
constexpr double kMinPhaseSigma = 0.02;  // [rad], chosen: below that of any known array
constexpr double kMinOutliers = 0.005;   // a share, chosen: none in a few dozen is no proof

}  // namespace

PhaseErrors fit_phase_errors(std::span<const double> errors) {
  PhaseErrors fit;
  if (errors.size() < kLeast) {
    return fit;
  }
  const auto count = static_cast<double>(errors.size());
  for (int round = 0; round < kRounds; ++round) {
    double inside = 0.0;
    double squares = 0.0;
    for (const double error : errors) {
      const double x = error / fit.sigma;
      const double near = (1.0 - fit.outliers) * std::exp(-0.5 * x * x) /
                          (fit.sigma * std::sqrt(2.0 * std::numbers::pi));
      const double share = near / (near + fit.outliers / (2.0 * std::numbers::pi));
      inside += share;
      squares += share * error * error;
    }
    fit.sigma = std::max(kMinPhaseSigma, std::sqrt(squares / std::max(inside, 1.0)));
    fit.outliers = std::max(kMinOutliers, 1.0 - inside / count);
  }
  return fit;
}

}  // namespace rayloc
