// The rounds of the joint calibration: from coarse to fine, each releases more than the one before
// (METHODS B4).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/calibrate/joint/room_unknowns.h"

namespace rayloc {

// A count: gains, materials, survey errors with cycles, and once more.
inline constexpr int kJointRounds = 4;

struct JointRound {
  double floor;       // of the share left unexplained, below which a sample pulls no more
  double scan_range;  // [m], of surfaces to either side
  bool corrections;   // materials and the gains and phases of surfaces
  bool survey;        // survey errors and the places of antennas
  bool cycles;        // other half-wave cycles are tried
};

// REQUIRES: index < kJointRounds.
const JointRound& joint_round(std::size_t index);

// Whether the round moves each unknown. `power`: surface_power(); of a surface that carries next to
// nothing the data say nothing either.
std::vector<char> released(const JointRound& round,
                           const RoomUnknowns& unknowns,
                           std::span<const double> power);

}  // namespace rayloc
