#include "engine/track/device_tracker.h"

#include <utility>

namespace rayloc {
namespace {

std::shared_ptr<const FreeSpace> free_space_of(const Localizer& localizer) {
  std::vector<Vec3d> access_points;
  for (const RoomAccessPoint& ap : localizer.room().access_points) {
    access_points.push_back(ap.array.pose.position);
  }
  return std::make_shared<const FreeSpace>(
      make_free_space(*localizer.room().scene, localizer.grid(), access_points));
}

}  // namespace

TrackerCounters& TrackerCounters::operator+=(const TrackerCounters& other) {
  begun += other.begun;
  lost += other.lost;
  moments += other.moments;
  used += other.used;
  out_of_order += other.out_of_order;
  unusable += other.unusable;
  unexplained += other.unexplained;
  refused += other.refused;
  return *this;
}

DeviceTracker::DeviceTracker(std::shared_ptr<const Localizer> localizer,
                             DeviceTrackerOptions options)
    : localizer_(std::move(localizer)),
      space_(free_space_of(*localizer_)),
      options_(std::move(options)) {}

bool DeviceTracker::coast(Tracks::value_type& track,
                          Timestamp until,
                          std::vector<DeviceUpdate>& updates) {
  auto& [device, entry] = track;
  while (entry.due < until) {
    auto estimate = entry.track.coast(entry.due);
    entry.due += options_.coasting_interval;
    if (estimate) {
      updates.push_back({device, *std::move(estimate)});
    }
    if (entry.track.state() == TrackState::kLost) {
      ++counters_.lost;
      return false;
    }
  }
  return true;
}

void DeviceTracker::hear_moment(Tracks::value_type& track,
                                std::span<const CsiFrame> frames,
                                std::vector<DeviceUpdate>& updates) {
  auto& [device, entry] = track;
  const bool begins = !entry.track.state();
  ++counters_.moments;
  auto estimate = entry.track.hear(frames);
  if (estimate) {
    ++counters_.used;
    counters_.begun += begins ? 1U : 0U;
    entry.due = estimate->location.time + options_.track.coast_after;
    updates.push_back({device, *std::move(estimate)});
    return;
  }
  switch (estimate.error()) {
    case MomentRefusal::kOutOfOrder:
      ++counters_.out_of_order;
      break;
    case MomentRefusal::kUnusable:
      ++counters_.unusable;
      break;
    case MomentRefusal::kUnexplained:
      ++counters_.unexplained;
      break;
  }
}

void DeviceTracker::hear(const MacAddress& device,
                         std::span<const CsiFrame> frames,
                         std::vector<DeviceUpdate>& updates,
                         std::optional<Timestamp> heard_since) {
  if (frames.empty()) {
    return;
  }
  auto found = tracks_.find(device);
  if (found != tracks_.end() &&
      !coast(*found, heard_since.value_or(frames.front().time), updates)) {
    tracks_.erase(found);
    found = tracks_.end();
  }
  if (found == tracks_.end()) {
    if (tracks_.size() >= options_.max_tracks && options_.always.count(device) == 0) {
      ++counters_.refused;
      return;
    }
    found = tracks_.emplace(device, Entry{Track(localizer_, space_, options_.track), {}}).first;
  }
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    while (end < frames.size() && frames[end].time - frames[begin].time <= options_.moment) {
      ++end;
    }
    hear_moment(*found, frames.subspan(begin, end - begin), updates);
    begin = end;
  }
  if (!found->second.track.state()) {
    tracks_.erase(found);
  }
}

bool DeviceTracker::follows(const MacAddress& device) const {
  const auto found = tracks_.find(device);
  return found != tracks_.end() && found->second.track.state() != TrackState::kTentative;
}

void DeviceTracker::restart(const std::string& reason, std::vector<DeviceUpdate>& updates) {
  for (auto& [device, entry] : tracks_) {
    updates.push_back({device, entry.track.end(reason)});
    ++counters_.lost;
  }
  tracks_.clear();
}

void DeviceTracker::advance(Timestamp now, std::vector<DeviceUpdate>& updates) {
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    it = coast(*it, now, updates) ? std::next(it) : tracks_.erase(it);
  }
}

}  // namespace rayloc
