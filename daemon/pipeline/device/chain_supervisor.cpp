#include "daemon/pipeline/device/chain_supervisor.h"

#include <utility>

#include "daemon/pipeline/device/calibration_warnings.h"
#include "daemon/pipeline/device/chain_texts.h"
#include "daemon/pipeline/warm/carried.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"

namespace rayloc {
namespace {

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

// Finds the references that contain the learned factors, and reports each access point once.
void ChainSupervisor::name_references(const Burst& burst, const ChainCapability& learner) {
  const std::vector<ChainState> states = learner.states();
  references_->observe(burst.transmitter, burst.frames, states);
  for (const ChainState& state : states) {
    if (references_->contains_factors(burst.transmitter, state.access_point) &&
        named_.insert(state.access_point).second) {
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
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto access_point = static_cast<std::size_t>(frames[i].access_point);
    if (references_->contains_factors(burst.transmitter, access_point)) {
      frames[i] = burst.frames[i];
    }
  }
  return frames;
}

void ChainSupervisor::check(const SiteTransmitter& fixed, const Burst& burst) {
  const auto all = rooms_.learners();
  const auto before = monitor_->warnings();
  watched_[burst.transmitter] = burst.last;
  if (!all.empty()) {
    name_references(burst, *all.front());
  }
  // The verdicts of the predecessor contain the bursts that it has checked.
  const auto checked = watched_before_.find(burst.transmitter);
  if (checked == watched_before_.end() || burst.last > checked->second) {
    monitor_->observe(placed(fixed), compared_frames(burst, all.empty() ? nullptr : all.front()));
  }
  for (const CalibrationWarning& warning : monitor_->warnings()) {
    if (!is_stated(warning, before) && warning.problem == CalibrationProblem::kChainPhaseJump &&
        !all.empty()) {
      all.front()->power_cycled(warning.access_point, burst.frames.back().time);
      keeper_.spread(*all.front(), all, rooms_.first());
    }
  }
  if (!all.empty()) {
    all.front()->receive_at(*fixed.position, burst.frames);
    keeper_.spread(*all.front(), all, rooms_.first());
  }
}

std::span<const CsiFrame> ChainSupervisor::accept(const Burst& burst,
                                                  const DeviceRoom& room,
                                                  std::vector<CsiFrame>& kept) {
  ChainCapability* learner = room.method->chains();
  if (learner == nullptr) {
    return burst.frames;
  }
  learner->receive(burst.frames);
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
             : std::make_shared<const std::vector<ChainState>>(keeper_.states());
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
  for (ChainCapability* learner : rooms_.learners()) {
    learner->restart();
  }
}

}  // namespace rayloc
