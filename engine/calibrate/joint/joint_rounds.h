// The rounds of the joint calibration: from coarse to fine, each releases more unknowns than the
// one before (METHODS B4).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/calibrate/joint/room_unknowns.h"

namespace rayloc {

// A count: gains, materials, survey errors with cycles, and a final round.
inline constexpr int kJointRounds = 4;

struct JointRound {
  double floor;       // of the unexplained share, below which a sample has no more influence
  double scan_range;  // [m], of surfaces, on each side
  bool corrections;   // materials and the gains and phases of surfaces
  bool survey;        // survey errors and the positions of antennas
  bool cycles;        // other half-wave cycles are tried
};

// REQUIRES: index < kJointRounds.
const JointRound& joint_round(std::size_t index);

// True for each unknown that the round changes. `power`: surface_power(); a surface that carries
// almost no power is not constrained by the data.
std::vector<char> released(const JointRound& round,
                           const RoomUnknowns& unknowns,
                           std::span<const double> power);

}  // namespace rayloc
