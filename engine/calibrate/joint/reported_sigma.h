// reported_sigma: reported standard deviations of the unknowns of the joint calibration.
//
// The Gaussian about the fit assumes that the model is right. For the offsets of surfaces, and in
// the last case for the chains, three errors are added that it does not contain: a surface may fit
// as well at another offset within a few centimetres (surface_scan.h), the trials of other
// half-wave cycles may cost little more (wave_cycles.h), and the room contains echoes that the
// model lacks (below): all points may agree on a wrong place.
#pragma once

#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"
#include "engine/calibrate/joint/wave_cycles.h"

namespace rayloc {

// Power that the rays of a room do not explain.
struct UnmodelledPower {
  std::vector<double> carried;  // surface_power()
  double unexplained = 0.0;     // mean_unexplained()
  double half_wave = 0.03;      // [m]
};

// Adds to the standard deviation of each surface's offset the effect of an echo that the model
// lacks. Such an echo is assumed to carry a share x of all unexplained power, exponentially
// distributed with mean kUnmodelledEcho. An echo weaker than the surface's own changes its phase,
// and with it the offset; if it is stronger, the surface was fitted to the echo, and the half-wave
// cycle is known from its prior only. A chain is determined by the whole array of every point, and
// its phase is changed by an echo that all of them share.
void widen_by_unmodelled_echo(const RoomUnknowns& unknowns,
                              const UnmodelledPower& power,
                              const JointState& state,
                              std::vector<double>& sigma);

// Standard deviation of every released unknown, 0 for the others: that of the Gaussian with all of
// the above.
std::vector<double> reported_sigma(const JointContext& context,
                                   const JointOptions& options,
                                   const JointState& state,
                                   std::span<const WaveCycle> other_cycles,
                                   const UnmodelledPower& power);

}  // namespace rayloc
