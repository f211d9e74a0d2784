// Half-wave cycles of surfaces: whether a surface that has been fitted would do better, or as well,
// half a wave further to either side.
//
// A scan of one surface with the rest held cannot tell once the rest has come to terms with the
// wrong cycle: the surface's own gain and phase, the survey errors and the array have taken up what
// is left. Here these are fitted anew for the cycle on trial. Where no surface alone does better,
// the strongest are tried in pairs (a wall can hold the wall opposite, and the array between them,
// in the wrong place), and after that the whole room is fitted anew from the trials that cost
// least.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"

namespace rayloc {

// What else a surface's offset could be.
struct WaveCycle {
  std::uint32_t surface = 0;
  double offset = 0.0;  // [m], of the surface, as JointState::values has it
  double excess = 0.0;  // of the cost there over that of the state
};

struct WaveCycleSearch {
  std::span<const std::uint32_t> surfaces;  // in this order
  double half_wave = 0.03;                  // [m]
  JointOptions options;                     // of the round, its iterations those of a trial
  std::function<bool()> go_on;              // asked before each trial
};

struct WaveCycles {
  bool moved = false;             // the state is another
  std::vector<WaveCycle> others;  // of every surface those that were tried last and not taken
};

// Moves `state` to better cycles as long as there are any.
WaveCycles settle_wave_cycles(const JointContext& context,
                              const WaveCycleSearch& search,
                              JointState& state);

// Adds to the standard deviation of each surface's offset what its other cycles are worth, as the
// odds exp(-excess) between them and the one that was taken.
void widen_by_wave_cycles(std::span<const WaveCycle> others,
                          const RoomUnknowns& unknowns,
                          const JointState& state,
                          std::vector<double>& sigma);

}  // namespace rayloc
