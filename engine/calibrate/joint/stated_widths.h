// stated_widths: how wide the joint calibration says that its unknowns are known.
//
// The Gaussian about the fit believes the model. For the offsets of surfaces, and of the last for
// the chains, three things are added that it cannot know: that a surface would fit as well
// elsewhere within a few centimetres (surface_scan.h), that the trials of other half-wave cycles
// cost little more (wave_cycles.h), and that the room holds echoes that the model lacks (below):
// all points may agree on a wrong place.
#pragma once

#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"
#include "engine/calibrate/joint/wave_cycles.h"

namespace rayloc {

// What the rays of a room leave to be doubted.
struct UnmodelledPower {
  std::vector<double> carried;  // surface_power()
  double unexplained = 0.0;     // mean_unexplained()
  double half_wave = 0.03;      // [m]
};

// Adds to the standard deviation of each surface's offset what an echo that the model lacks may do
// to it. Such an echo is taken to carry a share x of all that is left unexplained, exponentially
// distributed with mean kUnmodelledEcho. One weaker than the surface's own turns its phase, and
// with it the offset; one that is stronger is what the surface was fitted to, and then the
// half-wave cycle is known from its prior only. A chain is told by the whole array of every point,
// and turned by an echo that all of them share.
void widen_by_unmodelled_echo(const RoomUnknowns& unknowns,
                              const UnmodelledPower& power,
                              const JointState& state,
                              std::vector<double>& sigma);

// Standard deviation of every released unknown, 0 for the others: the Gaussian's, and all of the
// above.
std::vector<double> stated_widths(const JointContext& context,
                                  const JointOptions& options,
                                  const JointState& state,
                                  std::span<const WaveCycle> other_cycles,
                                  const UnmodelledPower& power);

}  // namespace rayloc
