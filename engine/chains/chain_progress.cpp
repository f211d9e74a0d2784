#include "engine/chains/chain_progress.h"

#include <algorithm>
#include <cmath>

#include "engine/base/constants.h"

namespace rayloc {
namespace {

// One decimal, rounded down: a required value is not stated as reached too early.
std::string decimal(double value) {
  const auto tenths = std::lround(std::floor(10.0 * value + 1e-9));
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

}  // namespace

std::string progress_text(const ChainState& state) {
  if (state.bursts < kChainBurstsNeeded) {
    return std::to_string(state.bursts) + " of at least " + std::to_string(kChainBurstsNeeded) +
           " bursts";
  }
  std::string text = std::to_string(state.bursts) + " bursts, evidence " +
                     decimal(std::clamp(state.evidence, 0.0, kChainEvidenceNeeded)) + " of " +
                     decimal(kChainEvidenceNeeded) + " for one state of the chains";
  if (state.evidence >= kChainEvidenceNeeded && state.phase_sigma >= kChainPhaseSigmaNeeded) {
    text += ", its phases to " +
            std::to_string(std::lround(std::ceil(kDegreesPerRadian * state.phase_sigma))) +
            " degrees, " + std::to_string(std::lround(kDegreesPerRadian * kChainPhaseSigmaNeeded)) +
            " needed";
  }
  return text;
}

}  // namespace rayloc
