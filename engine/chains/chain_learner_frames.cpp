// Frames with the factors of their chains removed.
#include <algorithm>
#include <complex>
#include <vector>

#include "engine/chains/chain_frames.h"
#include "engine/chains/chain_learner.h"

namespace rayloc {

std::vector<CsiFrame> ChainLearner::undone(std::span<const CsiFrame> frames) const {
  std::vector<CsiFrame> result(frames.begin(), frames.end());
  for (const auto& [number, learned] : aps_) {
    if (learned.state.knowledge == ChainKnowledge::kAsCalibrated) {
      continue;
    }
    const std::vector<std::complex<double>> undoing = inverses(learned.state.factors.factor);
    for (CsiFrame& frame : result) {
      if (frame.access_point == number) {
        multiply(localizer_->room().access_points[number], undoing, frame);
      }
    }
  }
  return result;
}

std::vector<CsiFrame> ChainLearner::accepted(std::span<const CsiFrame> frames) const {
  std::vector<CsiFrame> kept = undone(frames);
  std::erase_if(kept, [&](const CsiFrame& frame) {
    const auto found = aps_.find(frame.access_point);
    return found != aps_.end() && found->second.state.knowledge == ChainKnowledge::kLearning;
  });
  return kept;
}

}  // namespace rayloc
