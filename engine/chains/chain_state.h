// ChainState: what is known of the receive chains of one access point of a room.
#pragma once

#include <cstddef>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_refinement.h"

namespace rayloc {

enum class ChainKnowledge {
  kAsCalibrated,
  kLearning,  // they have turned, and nobody knows yet how
  kLearned,
};

// Of one access point of the room.
struct ChainState {
  std::size_t access_point = 0;
  ChainKnowledge knowledge = ChainKnowledge::kAsCalibrated;
  ChainFactors factors;           // that frames are divided by; while learning the last ones
  Timestamp since;                // of this knowledge; the time of a frame, or 0
  std::size_t bursts = 0;         // that counted since then
  std::size_t bursts_needed = 0;  // while learning: in all, as it looks now
  // While learning, of the state of the chains that explains most, when states were last compared:
  double evidence = 0.0;     // [nat], by which it explains more than any other
  double phase_sigma = 0.0;  // [rad], the largest of its phases
};

// What is needed before a state of the chains is used.
inline constexpr std::size_t kChainBurstsNeeded = 10;
inline constexpr double kChainEvidenceNeeded = 7.0;     // [nat], before all other states
inline constexpr double kChainPhaseSigmaNeeded = 0.35;  // [rad], 20 degrees: of each phase

}  // namespace rayloc
