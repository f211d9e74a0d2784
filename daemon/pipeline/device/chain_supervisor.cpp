#include "daemon/pipeline/device/chain_supervisor.h"

#include <utility>

#include "daemon/pipeline/device/calibration_warnings.h"
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
  monitor_ = std::make_unique<CalibrationMonitor>(std::make_shared<const RoomModel>(room));
  for (PersonReference& reference : *references) {
    const SiteTransmitter* fixed = find_fixed_transmitter(site, reference.mac);
    for (PersonLink& link : reference.links) {
      if (fixed != nullptr && fixed->position &&
          !room.access_points[link.access_point].gains.empty()) {
        monitor_->set_reference(placed(*fixed), link.access_point, std::move(link.empty));
      }
    }
  }
  keeper_.restore(rooms_.learners(), room);
  return {};
}

void ChainSupervisor::check(const SiteTransmitter& fixed, const Burst& burst) {
  const auto all = rooms_.learners();
  const auto before = monitor_->warnings();
  watched_[burst.transmitter] = burst.last;
  // The verdicts of the predecessor contain the bursts that it has checked.
  const auto checked = watched_before_.find(burst.transmitter);
  if (checked == watched_before_.end() || burst.last > checked->second) {
    if (all.empty() || all.front()->leaves_alone()) {
      monitor_->observe(placed(fixed), frames_on(rooms_.first().grid, burst.frames));
    } else {
      monitor_->observe(placed(fixed), all.front()->undone(burst.frames));
    }
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
  watched_.clear();
  watched_before_.clear();
  keeper_.restart();
  for (ChainCapability* learner : rooms_.learners()) {
    learner->restart();
  }
}

}  // namespace rayloc
