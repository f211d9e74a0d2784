#include "engine/calibrate/joint/reported_sigma.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/calibrate/joint/surface_scan.h"

namespace rayloc {
namespace {

// Share of the unexplained power in one echo: chosen on a furnished meeting room with four access
// points, compared with a corridor with four (engine/studies/2026-11-stated-widths.md).
constexpr double kUnmodelledEcho = 0.15;

// Variance of an offset whose half-wave cycle is determined by its prior only.
double variance_of_cycles(double value, double prior_sigma, double half_wave) {
  double mass = 0.0;
  double spread = 0.0;
  for (int cycle = -2; cycle <= 2; ++cycle) {
    const double off = half_wave * cycle;
    const double weight = std::exp(0.5 * (value * value - (value + off) * (value + off)) /
                                   (prior_sigma * prior_sigma));
    mass += weight;
    spread += weight * off * off;
  }
  return spread / mass;
}

}  // namespace

void widen_by_unmodelled_echo(const RoomUnknowns& unknowns,
                              const UnmodelledPower& power,
                              const JointState& state,
                              std::vector<double>& sigma) {
  for (std::uint32_t surface = 0; surface < power.carried.size(); ++surface) {
    const std::uint32_t i = unknowns.surface_offset(surface);
    if (sigma[i] <= 0.0) {
      continue;
    }
    const double echo = kUnmodelledEcho * power.unexplained;
    const double carried = std::max(power.carried[surface], 1e-9);
    // A phase of 2 pi is half a wave of offset. An echo of relative power q changes the phase by
    // sqrt(q / 2), and by no more than a fraction of a cycle while it is the weaker one.
    const double rotated =
        std::sqrt(0.5 * std::min(echo / carried, 1.0)) / (2.0 * std::numbers::pi);
    const double stronger = std::exp(-carried / std::max(echo, 1e-12));
    const double cycles = variance_of_cycles(state.values[i], unknowns[i].sigma, power.half_wave);
    sigma[i] = std::sqrt(sigma[i] * sigma[i] +
                         rotated * rotated * power.half_wave * power.half_wave + stronger * cycles);
  }
  // An object at an array causes the same echo at all points, but a different one at each antenna:
  // with relative power q it changes a chain's phase by sqrt(q / 2), and its gain by as much.
  const double of_chain = std::sqrt(0.5 * kUnmodelledEcho * power.unexplained);
  for (std::uint32_t i = 0; i < unknowns.size(); ++i) {
    const Unknown::Kind kind = unknowns[i].kind;
    if (sigma[i] > 0.0 &&
        (kind == Unknown::Kind::kChainGain || kind == Unknown::Kind::kChainPhase)) {
      sigma[i] = std::hypot(sigma[i], of_chain);
    }
  }
}

std::vector<double> reported_sigma(const JointContext& context,
                                   const JointOptions& options,
                                   const JointState& state,
                                   std::span<const WaveCycle> other_cycles,
                                   const UnmodelledPower& power) {
  std::vector<double> sigma = JointProblem(context).posterior(options, state);
  widen_by_other_cycles(context, options.floor, state, sigma);
  widen_by_wave_cycles(other_cycles, context.unknowns, state, sigma);
  widen_by_unmodelled_echo(context.unknowns, power, state, sigma);
  return sigma;
}

}  // namespace rayloc
