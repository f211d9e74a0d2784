#include "daemon/pipeline/device_estimator.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "daemon/messages/topic.h"
#include "daemon/pipeline/method_training.h"
#include "daemon/pipeline/warm/carried.h"
#include "daemon/pipeline/watch/stamp_check.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "engine/base/constants.h"
#include "engine/chains/coarse_fix.h"

namespace rayloc {
namespace {

CalibrationMonitor::Transmitter placed(const SiteTransmitter& fixed) {
  return {*fixed.position, device_model(fixed)};
}

// True if `all` has a warning of the same problem and access point, for any of its chains.
bool is_stated(const CalibrationWarning& warning, const std::vector<CalibrationWarning>& all) {
  return std::any_of(all.begin(), all.end(), [&](const CalibrationWarning& one) {
    return one.problem == warning.problem && one.access_point == warning.access_point;
  });
}

// True if earlier bursts of the transmitter had to be left out.
bool is_behind(const Burst& burst) { return burst.received_since < burst.first; }

// Frames of a track's last measurement.
std::span<const CsiFrame> last_moment(std::span<const CsiFrame> frames) {
  const Timestamp begin = frames.back().time - DeviceTrackerOptions().moment;
  const auto first = std::find_if(
      frames.begin(), frames.end(), [&](const CsiFrame& frame) { return frame.time >= begin; });
  return frames.subspan(static_cast<std::size_t>(first - frames.begin()));
}

LocationEstimate without_position(const Burst& burst,
                                  const StuckStamp& stamp,
                                  const RoomModel& room) {
  LocationEstimate estimate;
  estimate.time = estimate.capture_start = burst.first;
  estimate.capture_end = burst.last;
  estimate.reason = "access point " +
                    room.access_points[static_cast<std::size_t>(stamp.access_point)].id + ": " +
                    describe(stamp) + ", and frames that share one give no position";
  return estimate;
}

}  // namespace

DeviceEstimator::DeviceEstimator(Site site, Options options)
    : site_(std::move(site)),
      options_([&] {
        if (!options.names) {
          options.names = std::make_shared<TargetNames>();
        }
        return std::move(options);
      }()),
      chains_(options_.chains) {}

Expected<DeviceEstimator::Room> DeviceEstimator::prepare(
    std::shared_ptr<const RoomModel> room) const {
  const DeviceModel device = room->device;
  DeviceMethodInput input{std::move(room), options_.settings};
  for (const SiteTransmitter& transmitter : site_.transmitters) {
    input.listed.insert(transmitter.mac);
  }
  const Method& method = *options_.method;
  auto training = training_of(site_, method, *input.room);
  if (!training) {
    return tl::make_unexpected(std::move(training.error()));
  }
  input.training = *std::move(training);
  auto made = method.create_device(std::move(input));
  if (!made) {
    return tl::make_unexpected(std::move(made.error()));
  }
  return Room{device, *std::move(made)};
}

DeviceModel DeviceEstimator::device_of(const SiteTransmitter* stated) const {
  return stated == nullptr ? unlisted_device(site_) : device_model(*stated);
}

Expected<std::unique_ptr<DeviceEstimator>> DeviceEstimator::create(const Site& site,
                                                                   const Options& options) {
  std::unique_ptr<DeviceEstimator> estimator(new DeviceEstimator(site, options));
  Expected<RoomModel> room = load_room_model(site);
  if (!room) {
    return tl::make_unexpected(room.error());
  }
  std::vector<DeviceModel> devices;
  if (site.targets.track_unlisted) {
    devices.push_back(estimator->device_of(nullptr));
  }
  for (const SiteTransmitter& transmitter : site.transmitters) {
    const DeviceModel device = estimator->device_of(&transmitter);
    if (transmitter.role == TransmitterRole::kDevice &&
        std::find(devices.begin(), devices.end(), device) == devices.end()) {
      devices.push_back(device);
    }
  }
  if (devices.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      (site.directory / "site.toml").string() +
                          ": no device to locate: add a [[transmitter]] with role = \"device\", or "
                          "set unlisted = \"track\" in [targets]");
  }
  for (const DeviceModel& device : devices) {
    room->device = device;
    Expected<Room> prepared = estimator->prepare(std::make_shared<const RoomModel>(*room));
    if (!prepared) {
      return tl::make_unexpected(prepared.error());
    }
    estimator->rooms_.push_back(*std::move(prepared));
  }
  if (auto watched = estimator->watch_calibration(*room); !watched) {
    return tl::make_unexpected(std::move(watched.error()));
  }
  estimator->chains_.restore(estimator->learners(), *room);
  if (options.before) {
    estimator->go_on(*options.before);
  }
  return estimator;
}

void DeviceEstimator::go_on(const Carried& before) {
  numbers_ = TrackNumbers(before.devices, before.done);
  std::vector<ChainState> chains = before.chains;
  std::erase_if(chains, [&](const ChainState& state) {
    const auto& access_points = room().access_points;
    return state.access_point >= access_points.size() ||
           state.factors.factor.size() != access_points[state.access_point].cores.size();
  });
  chains_.go_on(chains, learners());
  monitor_->go_on(before.calibration);
  for (const Carried::Watched& watched : before.watched) {
    watched_before_[watched.transmitter] = watched.last;
  }
  watched_ = watched_before_;
  state_warnings();
}

void DeviceEstimator::carry(Carried& carried) const {
  carried.devices = numbers_.carried();
  for (const ChainState& state : chains_.states()) {
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
  for (const Room& room : rooms_) {
    carried.received = std::min(carried.received, room.method->received_until(carried.done));
  }
}

Expected<void> DeviceEstimator::watch_calibration(const RoomModel& room) {
  auto references = load_references(site_, room);
  if (!references) {
    return tl::make_unexpected(std::move(references.error()));
  }
  monitor_ = std::make_unique<CalibrationMonitor>(std::make_shared<const RoomModel>(room));
  for (PersonReference& reference : *references) {
    const SiteTransmitter* fixed = find_fixed_transmitter(site_, reference.mac);
    for (PersonLink& link : reference.links) {
      if (fixed != nullptr && fixed->position &&
          !room.access_points[link.access_point].gains.empty()) {
        monitor_->set_reference(placed(*fixed), link.access_point, std::move(link.empty));
      }
    }
  }
  return {};
}

void DeviceEstimator::check_calibration(const SiteTransmitter& fixed, const Burst& burst) {
  if (!fixed.position) {
    return;
  }
  const auto all = learners();
  const auto before = monitor_->warnings();
  watched_[burst.transmitter] = burst.last;
  // The verdicts of the predecessor contain the bursts that it has checked.
  const auto checked = watched_before_.find(burst.transmitter);
  if (checked == watched_before_.end() || burst.last > checked->second) {
    if (all.empty() || all.front()->leaves_alone()) {
      monitor_->observe(placed(fixed), frames_on(room().grid, burst.frames));
    } else {
      monitor_->observe(placed(fixed), all.front()->undone(burst.frames));
    }
  }
  for (const CalibrationWarning& warning : monitor_->warnings()) {
    if (!is_stated(warning, before) && warning.problem == CalibrationProblem::kChainPhaseJump &&
        !all.empty()) {
      all.front()->power_cycled(warning.access_point, burst.frames.back().time);
      chains_.spread(*all.front(), all, room());
    }
  }
  if (!all.empty()) {
    all.front()->receive(burst.frames, *fixed.position);
    chains_.spread(*all.front(), all, room());
  }
  state_warnings();
}

// The monitor's warnings come first: they state the size of the change.
void DeviceEstimator::state_warnings() {
  std::vector<CalibrationWarning> warnings = monitor_->warnings();
  for (CalibrationWarning& warning : chains_.warnings(room())) {
    if (!is_stated(warning, warnings)) {
      warnings.push_back(std::move(warning));
    }
  }
  for (CalibrationWarning& warning : dead_chains_.warnings(room())) {
    warnings.push_back(std::move(warning));
  }
  const std::lock_guard lock(mutex_);
  warnings_ = std::move(warnings);
}

std::vector<ChainLearner*> DeviceEstimator::learners() const {
  std::vector<ChainLearner*> all;
  for (const Room& room : rooms_) {
    if (ChainLearner* learner = room.method->chains()) {
      all.push_back(learner);
    }
  }
  return all;
}

// The frames of the access points whose chains are known, corrected to the calibration: those of
// the burst, or the remaining ones in `kept`.
std::span<const CsiFrame> DeviceEstimator::accepted(const Burst& burst,
                                                    Room& room,
                                                    std::vector<CsiFrame>& kept) {
  ChainLearner* learner = room.method->chains();
  if (learner == nullptr) {
    return burst.frames;
  }
  learner->receive(burst.frames);
  chains_.spread(*learner, learners(), room.room());
  state_warnings();
  if (learner->leaves_alone()) {
    return burst.frames;
  }
  kept = learner->accepted(burst.frames);
  return kept;
}

std::vector<CalibrationWarning> DeviceEstimator::calibration_warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

TrackerCounters DeviceEstimator::tracker_counters() const {
  const std::lock_guard lock(mutex_);
  return tracker_counters_;
}

void DeviceEstimator::publish_counters() {
  TrackerCounters sum;
  for (const Room& room : rooms_) {
    sum += room.method->tracker_counters();
  }
  const std::lock_guard lock(mutex_);
  tracker_counters_ = sum;
}

// Coarse snapshot of a burst without usable access points, where the room and the frames allow
// one.
LocationEstimate DeviceEstimator::coarse_estimate(const Work& work) const {
  DeviceMethod& method = *work.room->method;
  const std::string reason = chains_.reason(work.room->room());
  LocationEstimate estimate =
      locate_coarsely(*method.localizer(), method.chains()->undone(work.burst->frames));
  if (estimate.position) {
    estimate.warnings.push_back("coarse, without the phases of the antennas: " + reason);
  } else {
    estimate.reason = reason;
  }
  return estimate;
}

void DeviceEstimator::snapshot(Work& work) {
  LocationEstimate snapshot =
      work.frames.empty() ? coarse_estimate(work) : work.room->method->locate(work.frames, 0);
  Target target = target_of(work.burst->transmitter, snapshot.time);
  work.out->locations.push_back({std::move(snapshot), std::move(target), context_of(*work.room)});
  show_channel(work.frames, *work.room, work.out->locations.back());
  work.has_snapshot = true;
}

// The steps that depend on the order of bursts. Empty for a transmitter that is not a device.
std::optional<DeviceEstimator::Work> DeviceEstimator::receive(const Burst& burst, Estimates& out) {
  if (dead_chains_.observe(burst.frames, room())) {
    state_warnings();
  }
  const SiteTransmitter* stated = find_transmitter(site_, burst.transmitter);
  if (stated != nullptr && stated->role == TransmitterRole::kFixed) {
    check_calibration(*stated, burst);
    return std::nullopt;
  }
  if (stated == nullptr ? !site_.targets.track_unlisted
                        : stated->role != TransmitterRole::kDevice) {
    return std::nullopt;
  }
  const DeviceModel device = device_of(stated);
  const auto room = std::find_if(rooms_.begin(), rooms_.end(), [&](const Room& candidate) {
    return candidate.device == device;
  });
  if (const auto stamp = stuck_stamp(burst.frames)) {
    LocationEstimate estimate = without_position(burst, *stamp, room->room());
    Target target = target_of(burst.transmitter, estimate.time);
    out.locations.push_back({std::move(estimate), std::move(target), context_of(*room)});
    return std::nullopt;
  }
  Work work;
  work.burst = &burst;
  work.out = &out;
  work.room = &*room;
  work.first = out.locations.size();
  work.frames = accepted(burst, *room, work.kept);
  work.trust = room->method->trust(work.frames);
  work.warnings = calibration_warnings();
  if (is_behind(burst) && room->method->has_tracks() && !work.frames.empty()) {
    const std::size_t all = work.frames.size();
    work.frames = last_moment(work.frames);
    out.frames_left_out += all - work.frames.size();
  } else if (work.frames.empty() || options_.snapshots == Snapshots::kAlways ||
             !room->method->follows(burst.transmitter)) {
    snapshot(work);
  }
  return work;
}

void DeviceEstimator::track(std::vector<Work>& works) {
  for (Room& room : rooms_) {
    std::vector<ReceivedBurst> bursts;
    std::vector<Work*> received;
    for (Work& work : works) {
      if (work.room == &room && !work.frames.empty()) {
        bursts.push_back({{work.burst->transmitter,
                           work.frames,
                           work.burst->received_since,
                           work.trust.chain_fault},
                          work.trust.withdrawals});
        received.push_back(&work);
      }
    }
    const auto updates = room.method->track(bursts);
    for (std::size_t i = 0; i < received.size(); ++i) {
      state(*received[i], updates[i]);
    }
  }
}

void DeviceEstimator::state(Work& work, const std::vector<DeviceUpdate>& updates) {
  std::vector<Location>& locations = work.out->locations;
  append(updates, *work.room, *work.out);
  if (locations.size() == work.first) {
    if (is_behind(*work.burst)) {
      snapshot(work);
    }
  } else if (!work.has_snapshot) {
    show_channel(work.frames, *work.room, locations.back());
  }
}

void DeviceEstimator::estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) {
  std::vector<Work> works;
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    if (auto work = receive(bursts[i], out[i])) {
      works.push_back(*std::move(work));
    }
  }
  if (works.empty()) {
    return;
  }
  track(works);
  publish_counters();
  for (const Work& work : works) {
    for (const CalibrationWarning& warning : work.warnings) {
      if (warning.problem == CalibrationProblem::kDeadChain) {
        continue;  // contained in the location already
      }
      for (std::size_t i = work.first; i < work.out->locations.size(); ++i) {
        work.out->locations[i].estimate.warnings.push_back(warning.text);
      }
    }
  }
}

// Uses all frames that the location was computed from: when a device moves, the others of its burst
// belong to other positions.
void DeviceEstimator::show_channel(std::span<const CsiFrame> frames,
                                   const Room& room,
                                   const Location& location) {
  const std::shared_ptr<const Localizer> localizer = room.method->localizer();
  if (localizer == nullptr || !location.estimate.position || !channels_.is_wanted()) {
    return;
  }
  channels_.add({target_component(location.target),
                 location.target.name,
                 location.estimate.time,
                 *location.estimate.position,
                 {frames.begin(), frames.end()},
                 localizer});
}

void DeviceEstimator::advance(Timestamp time, Estimates& out) {
  for (Room& room : rooms_) {
    std::vector<DeviceUpdate> updates;
    room.method->advance(time, updates);
    append(updates, room, out);
  }
  numbers_.advance(time);
  publish_counters();
}

Rank DeviceEstimator::rank(const MacAddress& transmitter) const {
  if (find_transmitter(site_, transmitter) != nullptr) {
    return Rank::kListed;
  }
  const bool tracked = std::any_of(rooms_.begin(), rooms_.end(), [&](const Room& room) {
    return room.method->has_track(transmitter);
  });
  return tracked ? Rank::kTracked : Rank::kOther;
}

void DeviceEstimator::restart(const std::string& reason, Estimates& out) {
  monitor_->restart();
  watched_.clear();
  watched_before_.clear();
  channels_.clear();
  {
    const std::lock_guard lock(mutex_);
    warnings_.clear();
  }
  chains_.restart();
  dead_chains_.restart();
  for (Room& room : rooms_) {
    std::vector<DeviceUpdate> updates;
    room.method->restart(reason, updates);
    append(updates, room, out);
  }
  publish_counters();
}

Target DeviceEstimator::target_of(const MacAddress& device, Timestamp time) const {
  Target target;
  target.address = options_.names->text(device, time);
  target.is_hashed = options_.names->hashed();
  // A name would permanently disclose the address that the hash hides.
  const SiteTransmitter* stated = find_transmitter(site_, device);
  if (stated != nullptr && !target.is_hashed) {
    target.name = stated->name;
  }
  return target;
}

LocationContext DeviceEstimator::context_of(const Room& room) const {
  LocationContext context;
  context.site = site_.name;
  context.scene_hash = room.room().scene_hash;
  context.calibration_id = room.room().calibration_id;
  context.method = options_.method->name;
  context.valid_for = options_.valid_for;
  return context;
}

void DeviceEstimator::append(const std::vector<DeviceUpdate>& updates,
                             const Room& room,
                             Estimates& out) {
  for (const DeviceUpdate& update : updates) {
    const FilteredEstimate& estimate = update.estimate;
    Target target = target_of(update.device, estimate.location.time);
    const Timestamp time = estimate.location.time;
    target.track = numbers_.of(update.device, target_component(target), time);
    if (estimate.transition) {
      out.events.push_back({target, *estimate.transition, estimate.location.position});
    }
    out.locations.push_back(filtered_location(estimate, std::move(target), context_of(room)));
    if (estimate.state == TrackState::kLost) {
      numbers_.lost(update.device, time);
    }
  }
}

}  // namespace rayloc
