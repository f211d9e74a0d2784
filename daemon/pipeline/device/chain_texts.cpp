#include "daemon/pipeline/device/chain_texts.h"

#include <cmath>
#include <cstddef>

#include "engine/base/constants.h"
#include "engine/chains/chain_progress.h"

namespace rayloc {

std::string learning_text(const ChainState& state, const RoomModel& room) {
  return "learning the chains of " + room.access_points[state.access_point].id + ": " +
         progress_text(state);
}

std::string learning_texts(std::span<const ChainState> states, const RoomModel& room) {
  std::string text;
  for (const ChainState& state : states) {
    if (state.knowledge == ChainKnowledge::kLearning) {
      text += (text.empty() ? "" : "; ") + learning_text(state, room);
    }
  }
  return text;
}

std::string rotations_text(const ChainState& state, const RoomModel& room) {
  const RoomAccessPoint& ap = room.access_points[state.access_point];
  std::string text;
  const auto& factor = state.factors.factor;
  for (std::size_t m = 1; m < factor.size(); ++m) {
    text += (text.empty() ? "core " : ", core ") + std::to_string(ap.rx_chains[m]) + " by " +
            std::to_string(std::lround(kDegreesPerRadian * std::arg(factor[m] / factor[0]))) +
            " degrees +- " +
            std::to_string(std::lround(std::ceil(kDegreesPerRadian * state.factors.sigma[m])));
  }
  return text + " against core " + std::to_string(ap.rx_chains[0]);
}

CalibrationWarning learning_warning(const ChainState& state, const RoomModel& room) {
  const RoomAccessPoint& ap = room.access_points[state.access_point];
  CalibrationWarning warning;
  warning.problem = CalibrationProblem::kChainPhaseJump;
  warning.access_point = state.access_point;
  warning.text =
      "chain_phase_jump: access point " + ap.id + ": " +
      (ap.are_chains_known ? "its chain phases have changed since the calibration (a power cycle?)"
                           : "its chains are not known yet, as the site was not surveyed") +
      "; its CSI is not used; " + learning_text(state, room);
  return warning;
}

std::string other_reference_text(const RoomAccessPoint& access_point) {
  return "access point " + access_point.id +
         ": its empty room was recorded with other chain phases than its calibration; run "
         "`rayloc calibrate --rechain`, then `rayloc reference` again";
}

}  // namespace rayloc
