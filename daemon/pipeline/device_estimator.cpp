#include "daemon/pipeline/device_estimator.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "daemon/pipeline/warm/carried.h"
#include "daemon/pipeline/watch/stamp_check.h"
#include "daemon/site/model/room_model.h"

namespace rayloc {

DeviceEstimator::DeviceEstimator(Site site, Options options)
    : site_(std::move(site)),
      options_([&] {
        if (!options.names) {
          options.names = std::make_shared<TargetNames>();
        }
        return std::move(options);
      }()),
      rooms_(site_),
      chains_(options_.chains, rooms_),
      results_(site_, {std::string(options_.method->name), options_.valid_for, options_.names}),
      locator_(options_.snapshots, chains_, results_) {}

Expected<std::unique_ptr<DeviceEstimator>> DeviceEstimator::create(const Site& site,
                                                                   const Options& options) {
  std::unique_ptr<DeviceEstimator> estimator(new DeviceEstimator(site, options));
  Expected<RoomModel> room = load_room_model(site);
  RAYLOC_TRY(room);
  RAYLOC_TRY(estimator->rooms_.prepare(*options.method, options.settings, *room));
  RAYLOC_TRY(estimator->chains_.prepare(site, *room));
  if (options.before) {
    estimator->go_on(*options.before);
  }
  return estimator;
}

void DeviceEstimator::go_on(const Carried& before) {
  results_.go_on(before.devices, before.done);
  chains_.go_on(before);
  update_warnings();
}

void DeviceEstimator::carry(Carried& carried) const {
  carried.devices = results_.carried();
  chains_.carry(carried);
  carried.received = std::min(carried.received, rooms_.received_until(carried.done));
}

void DeviceEstimator::update_warnings() {
  warnings_.set(
      chains_.monitor_warnings(), chains_.chain_warnings(), dead_chains_.warnings(room()));
}

TrackerCounters DeviceEstimator::tracker_counters() const {
  const std::lock_guard lock(mutex_);
  return tracker_counters_;
}

void DeviceEstimator::publish_counters() {
  const TrackerCounters sum = rooms_.tracker_counters();
  const std::lock_guard lock(mutex_);
  tracker_counters_ = sum;
}

// The steps that depend on the order of bursts. Empty for a transmitter that is not a device.
std::optional<BurstWork> DeviceEstimator::receive(const Burst& burst, Estimates& out) {
  if (dead_chains_.observe(burst.frames, room())) {
    update_warnings();
  }
  const SiteTransmitter* stated = find_transmitter(site_, burst.transmitter);
  if (stated != nullptr && stated->role == TransmitterRole::kFixed) {
    if (stated->position) {
      chains_.check(*stated, burst);
      update_warnings();
    }
    out.chains = chains_.shared_states();
    return std::nullopt;
  }
  if (stated == nullptr ? !site_.targets.track_unlisted
                        : stated->role != TransmitterRole::kDevice) {
    return std::nullopt;
  }
  const DeviceRoom& room = rooms_.of(stated);
  if (const auto stamp = stuck_stamp(burst.frames)) {
    locator_.refuse(burst, *stamp, room.room(), out);
    return std::nullopt;
  }
  BurstWork work;
  work.burst = &burst;
  work.out = &out;
  work.room = &room;
  work.first = out.locations.size();
  work.frames = chains_.accept(burst, room, work.kept);
  update_warnings();
  work.trust = chains_.trust(room, work.frames);
  work.warnings = warnings_.now();
  locator_.begin(work);
  return work;
}

void DeviceEstimator::estimate_each(std::span<const Burst> bursts, std::span<Estimates> out) {
  std::vector<BurstWork> works;
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    if (auto work = receive(bursts[i], out[i])) {
      works.push_back(*std::move(work));
    }
  }
  if (works.empty()) {
    return;
  }
  locator_.track(works, rooms_.all());
  publish_counters();
  for (const BurstWork& work : works) {
    append_texts(work.warnings, std::span(work.out->locations).subspan(work.first));
  }
}

void DeviceEstimator::advance(Timestamp time, const IsWaiting& is_waiting, Estimates& out) {
  for (const DeviceRoom& room : rooms_.all()) {
    if (TrackCapability* tracks = room.method->tracks()) {
      std::vector<DeviceUpdate> updates;
      tracks->advance(time, updates, is_waiting);
      results_.append(updates, room.room(), out);
    }
  }
  results_.advance(time);
  publish_counters();
}

Rank DeviceEstimator::rank(const MacAddress& transmitter) const {
  const bool has_track = rooms_.has_track(transmitter);
  if (const SiteTransmitter* stated = find_transmitter(site_, transmitter)) {
    return has_track || stated->role != TransmitterRole::kDevice ? Rank::kListed
                                                                 : Rank::kListedAcquisition;
  }
  return has_track ? Rank::kTracked : Rank::kOther;
}

void DeviceEstimator::restart(const std::string& reason, Estimates& out) {
  chains_.restart();
  locator_.channels().clear();
  warnings_.clear();
  dead_chains_.restart();
  for (const DeviceRoom& room : rooms_.all()) {
    if (TrackCapability* tracks = room.method->tracks()) {
      std::vector<DeviceUpdate> updates;
      tracks->restart(reason, updates);
      results_.append(updates, room.room(), out);
    }
  }
  publish_counters();
}

}  // namespace rayloc
