// Half-wave cycles of surfaces: tests whether a fitted surface would fit better, or as well, half a
// wave further to either side.
//
// A scan of one surface with the rest held cannot decide once the rest has adapted to the wrong
// cycle: the surface's own gain and phase, the survey errors and the array have absorbed the
// residual. Here these are fitted anew for the cycle on trial. Where no single surface improves the
// fit, the strongest are tried in pairs (a wall can hold the wall opposite, and the array between
// them, in the wrong place), and after that the whole room is fitted anew from the trials with the
// lowest cost.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/calibrate/joint/joint_problem.h"

namespace rayloc {

// An alternative offset of a surface.
struct WaveCycle {
  std::uint32_t surface = 0;
  double offset = 0.0;  // [m], of the surface, as in JointState::values
  double excess = 0.0;  // cost there minus the cost of the state
};

struct WaveCycleSearch {
  std::span<const std::uint32_t> surfaces;  // in order of trial
  double half_wave = 0.03;                  // [m]
  JointOptions options;                     // of the round, with the iterations of a trial
  std::function<bool()> go_on;              // called before each trial
};

struct WaveCycles {
  bool moved = false;             // the state has changed
  std::vector<WaveCycle> others;  // per surface, those tried last and not taken
};

// Moves `state` to better cycles until none is better.
WaveCycles settle_wave_cycles(const JointContext& context,
                              const WaveCycleSearch& search,
                              JointState& state);

// Adds to the standard deviation of each surface's offset the effect of its other cycles, with odds
// exp(-excess) relative to the one that was taken.
void widen_by_wave_cycles(std::span<const WaveCycle> others,
                          const RoomUnknowns& unknowns,
                          const JointState& state,
                          std::vector<double>& sigma);

}  // namespace rayloc
