#include "daemon/pipeline/device/chain_keeper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "daemon/pipeline/device/chain_file.h"
#include "engine/base/constants.h"
#include "engine/chains/chain_progress.h"

namespace rayloc {
namespace {

std::string learning(const ChainState& state, const RoomModel& room) {
  return "learning the chains of " + room.access_points[state.access_point].id + ": " +
         progress_text(state);
}

// "core 0 by 173 degrees +- 5, core 3 by 113 degrees +- 6"
std::string turns(const ChainState& state, const RoomAccessPoint& ap) {
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

bool differs(const ChainState& a, const ChainState& b) {
  return a.knowledge != b.knowledge || a.factors.factor != b.factors.factor;
}

}  // namespace

void ChainKeeper::notify(std::string line) {
  const std::lock_guard lock(mutex_);
  notices_.push_back(std::move(line));
}

void ChainKeeper::restore(const std::vector<ChainCapability*>& learners, const RoomModel& room) {
  if (options_.read.empty() || learners.empty()) {
    return;
  }
  const auto states = read_chain_file(options_.read, room);
  if (!states) {
    notify(states.error().message);
    return;
  }
  for (ChainState state : *states) {
    const bool is_learned = state.knowledge == ChainKnowledge::kLearned;
    if (!is_learned) {
      state.bursts = 0;  // not stored in the file
    }
    for (ChainCapability* learner : learners) {
      learner->restore(state);
    }
    const RoomAccessPoint& ap = room.access_points[state.access_point];
    notify("access point " + ap.id + ": " +
           (is_learned ? "its chains are as learned before: " + turns(state, ap)
                       : "its chains were not known when " + options_.read + " was written; " +
                             learning(state, room)));
  }
  keep(learners.front()->states());
}

void ChainKeeper::go_on(const std::vector<ChainState>& states,
                        const std::vector<ChainCapability*>& learners) {
  if (states.empty() || learners.empty()) {
    return;
  }
  for (const ChainState& state : states) {
    for (ChainCapability* learner : learners) {
      learner->restore(state);
    }
  }
  keep(learners.front()->states());
}

void ChainKeeper::keep(std::vector<ChainState> states) {
  const std::lock_guard lock(mutex_);
  known_ = std::move(states);
}

void ChainKeeper::restart() {
  seen_.clear();
  keep({});
}

std::vector<ChainState> ChainKeeper::states() const {
  const std::lock_guard lock(mutex_);
  return known_;
}

void ChainKeeper::spread(const ChainCapability& learner,
                         const std::vector<ChainCapability*>& learners,
                         const RoomModel& room) {
  const auto seen = seen_.find(&learner);
  if (seen != seen_.end() && seen->second == learner.changes()) {
    return;
  }
  seen_[&learner] = learner.changes();
  const std::vector<ChainState> states = learner.states();
  bool is_new = false;
  for (const ChainState& state : states) {
    const auto before = std::find_if(known_.begin(), known_.end(), [&](const ChainState& one) {
      return one.access_point == state.access_point;
    });
    const bool is_first = before == known_.end();
    if (is_first ? state.knowledge == ChainKnowledge::kAsCalibrated : !differs(*before, state)) {
      continue;
    }
    is_new = true;
    for (ChainCapability* other : learners) {
      if (other != &learner) {
        other->adopt(state);
      }
    }
    if (!is_first && before->knowledge == state.knowledge) {
      continue;  // refined
    }
    const RoomAccessPoint& ap = room.access_points[state.access_point];
    notify(state.knowledge == ChainKnowledge::kLearned
               ? "access point " + ap.id + ": its chains are learned, rotated " +
                     (ap.are_chains_known ? "since the calibration: " : "by: ") + turns(state, ap)
               : "access point " + ap.id +
                     (ap.are_chains_known ? ": its chain phases have changed; "
                                          : ": its chains are not known yet; ") +
                     learning(state, room));
  }
  keep(states);
  if (is_new && !options_.write.empty()) {
    if (const auto written = write_chain_file(options_.write, states, room); !written) {
      notify(written.error().message);
    }
  }
}

std::vector<CalibrationWarning> ChainKeeper::warnings(const RoomModel& room) const {
  std::vector<CalibrationWarning> result;
  for (const ChainState& state : known_) {
    if (state.knowledge == ChainKnowledge::kLearning) {
      CalibrationWarning& warning = result.emplace_back();
      warning.problem = CalibrationProblem::kChainPhaseJump;
      warning.access_point = state.access_point;
      const RoomAccessPoint& ap = room.access_points[state.access_point];
      warning.text = "chain_phase_jump: access point " + ap.id + ": " +
                     (ap.are_chains_known
                          ? "its chain phases have changed since the calibration (a power cycle?)"
                          : "its chains are not known yet, as the site was not surveyed") +
                     "; its CSI is not used; " + learning(state, room);
    }
  }
  return result;
}

std::string ChainKeeper::reason(const RoomModel& room) const {
  std::string text;
  for (const ChainState& state : states()) {
    if (state.knowledge == ChainKnowledge::kLearning) {
      text += (text.empty() ? "" : "; ") + learning(state, room);
    }
  }
  return text;
}

std::vector<std::string> ChainKeeper::notices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notices_, {});
}

}  // namespace rayloc
