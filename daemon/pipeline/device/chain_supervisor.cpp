#include "daemon/pipeline/device/chain_supervisor.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "daemon/pipeline/device/calibration_warnings.h"
#include "daemon/pipeline/device/chain_texts.h"
#include "daemon/pipeline/warm/carried.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "engine/chains/chain_frames.h"

namespace rayloc {
namespace {

// Probabilities that restored chains are wrong, chosen: 0.1 before the first burst, which one clear
// burst changes to about 0.002 or 0.86.
constexpr double kConfirmed = 0.01;
constexpr double kContradicted = 0.5;

CalibrationMonitor::Transmitter placed(const SiteTransmitter& fixed) {
  return {*fixed.position, device_model(fixed)};
}

}  // namespace

Expected<void> ChainSupervisor::prepare(const Site& site, const RoomModel& room) {
  auto references = load_references(site, room);
  RAYLOC_TRY(references);
  const auto shared = std::make_shared<const RoomModel>(room);
  monitor_ = std::make_unique<CalibrationMonitor>(shared);
  references_ = std::make_unique<ReferenceChains>(shared);
  for (PersonReference& reference : *references) {
    const SiteTransmitter* fixed = find_fixed_transmitter(site, reference.mac);
    for (PersonLink& link : reference.links) {
      if (fixed != nullptr && fixed->position &&
          !room.access_points[link.access_point].gains.empty()) {
        references_->add(reference.mac, link.access_point, link.empty);
        monitor_->set_reference(placed(*fixed), link.access_point, std::move(link.empty));
      }
    }
  }
  keeper_.restore(rooms_.learners(), room);
  return {};
}

std::vector<ChainState> ChainSupervisor::with_confirmation(std::vector<ChainState> states) const {
  for (ChainState& state : states) {
    state.is_confirmed =
        state.knowledge == ChainKnowledge::kLearned && confirmed_.count(state.access_point) != 0;
  }
  return states;
}

// Chains that were learned since the start are confirmed.
void ChainSupervisor::note_learned(const ChainCapability& learner) {
  for (const ChainState& state : learner.states()) {
    if (state.knowledge != ChainKnowledge::kLearned) {
      unlearned_.insert(state.access_point);
      confirmed_.erase(state.access_point);
      kept_.erase(state.access_point);
    } else if (unlearned_.count(state.access_point) != 0) {
      confirmed_.insert(state.access_point);
    }
  }
}

// A counted burst of a device confirms or contradicts chains of an earlier run.
void ChainSupervisor::judge(const Burst& burst, ChainCapability& learner) {
  for (const ChainState& state : learner.states()) {
    const std::size_t number = state.access_point;
    if (state.knowledge != ChainKnowledge::kLearned || confirmed_.count(number) != 0) {
      continue;
    }
    std::vector<CsiFrame> own = burst.frames;
    std::erase_if(own, [&](const CsiFrame& frame) { return frame.access_point != number; });
    if (own.empty()) {
      continue;
    }
    const double wrong = learner.trust(own).chain_fault.probability;
    if (wrong < kConfirmed) {
      confirmed_.insert(number);
    } else if (wrong > kContradicted && kept_.erase(number) != 0) {
      learner.power_cycled(number, burst.frames.back().time);
    }
  }
}

// Finds the references that contain learned factors, and reports each access point once.
void ChainSupervisor::report_references(const Burst& burst, const ChainCapability& learner) {
  const std::vector<ChainState> states = with_confirmation(learner.states());
  references_->observe(burst.transmitter, burst.frames, states);
  for (const ChainState& state : states) {
    if (!references_->recorded(burst.transmitter, state.access_point).empty() &&
        reported_.insert(state.access_point).second) {
      keeper_.notify(other_reference_text(rooms_.first().access_points[state.access_point]));
    }
  }
}

// The frames of a fixed transmitter with the chains of its expected array. `learner`: may be null.
std::vector<CsiFrame> ChainSupervisor::compared_frames(const Burst& burst,
                                                       const ChainCapability* learner) const {
  if (learner == nullptr || learner->leaves_alone()) {
    return frames_on(rooms_.first().grid, burst.frames);
  }
  std::vector<CsiFrame> frames = learner->undone(burst.frames);
  for (CsiFrame& frame : frames) {
    const auto recorded = references_->recorded(burst.transmitter, frame.access_point);
    if (!recorded.empty()) {
      multiply(rooms_.first().access_points[frame.access_point], recorded, frame);
    }
  }
  return frames;
}

// True for learned chains of an earlier run where the array of the fixed transmitter may contain
// their factors, since its frames fit as received.
bool ChainSupervisor::keep_restored(const Burst& burst,
                                    std::size_t access_point,
                                    const ChainCapability& learner) {
  const std::vector<ChainState> states = learner.states();
  const bool is_restored = std::any_of(states.begin(),
                                       states.end(),
                                       [&](const ChainState& state) {
                                         return state.access_point == access_point &&
                                                state.knowledge == ChainKnowledge::kLearned;
                                       }) &&
                           confirmed_.count(access_point) == 0;
  if (!is_restored || !references_->is_undecided(burst.transmitter, access_point) ||
      references_->presumed(burst.transmitter, access_point).empty()) {
    return false;
  }
  if (kept_.insert(access_point).second) {
    keeper_.notify(
        "access point " + rooms_.first().access_points[access_point].id +
        ": its empty room fits without the chains as learned before; they are kept "
        "until a burst of a device contradicts them. If the warning remains, run `rayloc "
        "calibrate --rechain`, then `rayloc reference` again");
  }
  return true;
}

// The fixed transmitter shows other chains than those of its expected array.
void ChainSupervisor::report_jump(const Burst& burst,
                                  std::size_t access_point,
                                  ChainCapability& learner) {
  if (!keep_restored(burst, access_point, learner)) {
    learner.power_cycled(access_point, burst.frames.back().time);
    keeper_.spread(learner, rooms_.learners(), rooms_.first());
  }
}

void ChainSupervisor::check(const SiteTransmitter& fixed, const Burst& burst) {
  const auto all = rooms_.learners();
  const auto before = monitor_->warnings();
  watched_[burst.transmitter] = burst.last;
  if (!all.empty()) {
    note_learned(*all.front());
    report_references(burst, *all.front());
  }
  // The verdicts of the predecessor contain the bursts that it has checked.
  const auto checked = watched_before_.find(burst.transmitter);
  if (checked == watched_before_.end() || burst.last > checked->second) {
    monitor_->observe(placed(fixed), compared_frames(burst, all.empty() ? nullptr : all.front()));
  }
  for (const CalibrationWarning& warning : monitor_->warnings()) {
    if (!is_stated(warning, before) && warning.problem == CalibrationProblem::kChainPhaseJump &&
        !all.empty()) {
      report_jump(burst, warning.access_point, *all.front());
    }
  }
  if (!all.empty()) {
    all.front()->receive_at(*fixed.position, burst.frames);
    keeper_.spread(*all.front(), all, rooms_.first());
    note_learned(*all.front());
  }
}

std::span<const CsiFrame> ChainSupervisor::accept(const Burst& burst,
                                                  const DeviceRoom& room,
                                                  std::vector<CsiFrame>& kept) {
  ChainCapability* learner = room.method->chains();
  if (learner == nullptr) {
    return burst.frames;
  }
  note_learned(*learner);
  const std::uint64_t changes = learner->changes();
  learner->receive(burst.frames);
  note_learned(*learner);
  if (learner->changes() != changes) {
    judge(burst, *learner);
  }
  keeper_.spread(*learner, rooms_.learners(), room.room());
  if (learner->leaves_alone()) {
    return burst.frames;
  }
  kept = learner->accepted(burst.frames);
  return kept;
}

ChainTrust ChainSupervisor::trust(const DeviceRoom& room,
                                  std::span<const CsiFrame> accepted) const {
  const ChainCapability* learner = room.method->chains();
  return learner == nullptr ? ChainTrust() : learner->trust(accepted);
}

LocationEstimate ChainSupervisor::locate_coarsely(const Burst& burst,
                                                  const DeviceRoom& room) const {
  const std::string reason = keeper_.reason(room.room());
  LocationEstimate estimate = room.method->chains()->locate_coarsely(burst.frames);
  if (estimate.position) {
    estimate.warnings.push_back("coarse, without the phases of the antennas: " + reason);
  } else {
    estimate.reason = estimate.reason.empty()
                          ? reason
                          : reason + "; without the phases of the antennas: " + estimate.reason;
  }
  return estimate;
}

std::shared_ptr<const std::vector<ChainState>> ChainSupervisor::shared_states() const {
  return rooms_.learners().empty()
             ? nullptr
             : std::make_shared<const std::vector<ChainState>>(with_confirmation(keeper_.states()));
}

void ChainSupervisor::go_on(const Carried& before) {
  std::vector<ChainState> chains = before.chains;
  std::erase_if(chains, [&](const ChainState& state) {
    const auto& access_points = rooms_.first().access_points;
    return state.access_point >= access_points.size() ||
           state.factors.factor.size() != access_points[state.access_point].rx_chains.size();
  });
  keeper_.go_on(chains, rooms_.learners());
  monitor_->go_on(before.calibration);
  for (const Carried::Watched& watched : before.watched) {
    watched_before_[watched.transmitter] = watched.last;
  }
  watched_ = watched_before_;
}

void ChainSupervisor::carry(Carried& carried) const {
  for (const ChainState& state : keeper_.states()) {
    if (state.knowledge != ChainKnowledge::kAsCalibrated) {
      carried.chains.push_back(state);
    }
  }
  for (CalibrationMonitor::MonitorState& monitor_state : monitor_->monitor_state()) {
    if (monitor_state.bursts > 0 || monitor_state.slow) {
      carried.calibration.push_back(std::move(monitor_state));
    }
  }
  for (const auto& [mac, last] : watched_) {
    carried.watched.push_back({mac, last});
  }
}

void ChainSupervisor::restart() {
  monitor_->restart();
  references_->restart();
  watched_.clear();
  watched_before_.clear();
  keeper_.restart();
  unlearned_.clear();
  confirmed_.clear();
  kept_.clear();
  for (ChainCapability* learner : rooms_.learners()) {
    learner->restart();
  }
}

}  // namespace rayloc
