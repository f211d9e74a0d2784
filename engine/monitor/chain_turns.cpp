#include "engine/monitor/chain_turns.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayloc {

ChainTurns::ChainTurns(std::size_t chains)
    : relative_(chains, std::vector<std::complex<double>>(chains)) {}

void ChainTurns::add(std::span<const std::complex<double>> phasor) {
  for (std::size_t n = 0; n < relative_.size(); ++n) {
    for (std::size_t m = 0; m < relative_.size(); ++m) {
      relative_[n][m] += phasor[m] * std::conj(phasor[n]);
    }
  }
}

std::vector<double> ChainTurns::turns() const {
  std::vector<double> best;
  double least = 0.0;
  for (const std::vector<std::complex<double>>& against : relative_) {
    std::vector<double> turn;
    double sum = 0.0;
    for (const std::complex<double>& value : against) {
      turn.push_back(std::arg(value));
      sum += std::abs(turn.back());
    }
    if (best.empty() || sum < least) {
      best = std::move(turn);
      least = sum;
    }
  }
  return best;
}

double turn_variance(double share) {
  constexpr double kMinShare = 1e-3;  // below this share the phase carries no information
  const double explained = std::clamp(share, kMinShare, 1.0);
  return 2.0 * (1.0 - explained) / explained;
}

}  // namespace rayloc
