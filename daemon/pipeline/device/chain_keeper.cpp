#include "daemon/pipeline/device/chain_keeper.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "daemon/pipeline/device/chain_file.h"
#include "daemon/pipeline/device/chain_texts.h"
#include "engine/chains/chain_record.h"

namespace rayloc {
namespace {

bool differs(const ChainState& a, const ChainState& b) {
  return a.knowledge != b.knowledge || a.factors.factor != b.factors.factor;
}

// True if the learner has this state; its evidence may be another one.
bool has_state(const ChainCapability& learner, const ChainState& state) {
  const std::vector<ChainState> own = learner.states();
  return std::any_of(own.begin(), own.end(), [&](const ChainState& one) {
    return one.access_point == state.access_point && one.since == state.since &&
           !differs(one, state);
  });
}

// True if a learner has restored evidence on the same unknown chains from the file.
bool has_evidence(const ChainState& state, const std::vector<ChainCapability*>& learners) {
  return std::any_of(learners.begin(), learners.end(), [&](const ChainCapability* learner) {
    return learner->record(state.access_point) && has_state(*learner, state);
  });
}

// The evidence of the learner that has the most bursts; null if none has evidence.
std::shared_ptr<const ChainRecord> most_evidence(std::size_t access_point,
                                                 const std::vector<ChainCapability*>& learners) {
  std::optional<ChainRecord> most;
  for (std::size_t i = 0; i < learners.size(); ++i) {
    std::optional<ChainRecord> record = learners[i]->record(access_point);
    if (record && (!most || record->received.size() > most->received.size())) {
      most = std::move(record);
      most->learner = i;
      most->learners = learners.size();
    }
  }
  return most ? std::make_shared<const ChainRecord>(*std::move(most)) : nullptr;
}

// True if the stored evidence is of as many learners, so that each may continue with its own.
bool is_comparable(const ChainState& state, std::size_t learners) {
  return state.record != nullptr && state.record->learners == learners;
}

// The state with the progress of the stored evidence, for a report.
ChainState with_evidence(ChainState state, std::size_t learners) {
  const bool is_used = is_comparable(state, learners);
  state.bursts = is_used ? state.record->bursts : state.bursts;
  state.evidence = is_used ? state.record->lead : 0.0;
  state.phase_sigma = is_used ? state.record->phase_sigma : 0.0;
  return state;
}

std::size_t bursts_while_learning(const std::vector<ChainState>& states) {
  std::size_t bursts = 0;
  for (const ChainState& state : states) {
    bursts += state.knowledge == ChainKnowledge::kLearning ? state.bursts : 0;
  }
  return bursts;
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
    state.bursts = is_learned ? state.bursts : 0;  // those of the evidence count, if any
    for (std::size_t i = 0; i < learners.size(); ++i) {
      ChainState own = state;
      own.record = is_comparable(state, learners.size()) && state.record->learner == i
                       ? state.record
                       : nullptr;
      learners[i]->restore(own);
    }
    notify("access point " + room.access_points[state.access_point].id + ": " +
           (is_learned ? "its chains are as learned before: " + rotations_text(state, room)
                       : "its chains were not known when " + options_.read + " was written; " +
                             learning_text(with_evidence(state, learners.size()), room)));
  }
  keep(learners.front()->states());
}

void ChainKeeper::go_on(const std::vector<ChainState>& states,
                        const std::vector<ChainCapability*>& learners) {
  if (states.empty() || learners.empty()) {
    return;
  }
  for (const ChainState& state : states) {
    if (has_evidence(state, learners)) {
      continue;
    }
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
  stored_.clear();
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
      // A learner that adopts a state loses its own evidence on it.
      if (other != &learner && !has_state(*other, state)) {
        other->adopt(state);
      }
    }
    if (!is_first && before->knowledge == state.knowledge) {
      continue;  // refined
    }
    const RoomAccessPoint& ap = room.access_points[state.access_point];
    notify(state.knowledge == ChainKnowledge::kLearned
               ? "access point " + ap.id + ": its chains are learned, rotated " +
                     (ap.are_chains_known ? "since the calibration: " : "by: ") +
                     rotations_text(state, room)
               : "access point " + ap.id +
                     (ap.are_chains_known ? ": its chain phases have changed; "
                                          : ": its chains are not known yet; ") +
                     learning_text(state, room));
  }
  keep(states);
  // A count, chosen: with more bursts the file is written again after a growing number of them, a
  // part of those counted, since chains that are never learned have no last burst.
  constexpr std::size_t kFewBursts = 32;
  const std::size_t bursts = bursts_while_learning(states);
  std::size_t& stored = stored_[&learner];
  if (is_new || bursts < stored || bursts > stored + stored / kFewBursts) {
    stored = bursts;
    const auto written = write(states, learners, room);
    if (!written && (is_new || !has_failed_)) {
      notify(written.error().message);
    }
    has_failed_ = !written;
  }
}

Expected<void> ChainKeeper::write(std::vector<ChainState> states,
                                  const std::vector<ChainCapability*>& learners,
                                  const RoomModel& room) const {
  if (options_.write.empty()) {
    return {};
  }
  for (ChainState& state : states) {
    if (state.knowledge == ChainKnowledge::kLearning) {
      state.record = most_evidence(state.access_point, learners);
    }
  }
  return write_chain_file(options_.write, states, room);
}

std::vector<CalibrationWarning> ChainKeeper::warnings(const RoomModel& room) const {
  std::vector<CalibrationWarning> result;
  for (const ChainState& state : known_) {
    if (state.knowledge == ChainKnowledge::kLearning) {
      result.push_back(learning_warning(state, room));
    }
  }
  return result;
}

std::string ChainKeeper::reason(const RoomModel& room) const {
  return learning_texts(states(), room);
}

std::vector<std::string> ChainKeeper::notices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notices_, {});
}

}  // namespace rayloc
