// ChainState: estimated state of the receive chains of one access point of a room.
#pragma once

#include <cstddef>
#include <memory>

#include "engine/base/timestamp.h"
#include "engine/chains/chain_refinement.h"

namespace rayloc {

struct ChainRecord;

enum class ChainKnowledge {
  kAsCalibrated,
  kLearning,  // phases have changed, the new ones are not yet known
  kLearned,
};

// State of one access point of the room.
struct ChainState {
  std::size_t access_point = 0;
  ChainKnowledge knowledge = ChainKnowledge::kAsCalibrated;
  ChainFactors factors;           // divisors of the frames; while learning, the last ones
  Timestamp since;                // start of this knowledge; the time of a frame, or 0
  std::size_t bursts = 0;         // counted bursts since then
  std::size_t bursts_needed = 0;  // while learning: present estimate of the total
  // While learning, for the best state at the last comparison of states:
  double evidence = 0.0;     // [nat], lead over every other state
  double phase_sigma = 0.0;  // [rad], largest over its phases
  // Evidence to continue from, for a learner that restores this state, and for a file; else null.
  std::shared_ptr<const ChainRecord> record;
  // Learned chains that bursts since the start have confirmed; set by the owner of the learner.
  bool is_confirmed = false;
};

// Requirements for using a state of the chains.
inline constexpr std::size_t kChainBurstsNeeded = 10;
inline constexpr double kChainEvidenceNeeded = 7.0;     // [nat], lead over all other states
inline constexpr double kChainPhaseSigmaNeeded = 0.35;  // [rad], 20 degrees: for each phase

}  // namespace rayloc
