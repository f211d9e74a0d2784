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

DeviceTracker::DeviceTracker(std::shared_ptr<const Localizer> localizer,
                             DeviceTrackerOptions options)
    : localizer_(std::move(localizer)),
      space_(free_space_of(*localizer_)),
      options_(std::move(options)) {}

bool DeviceTracker::coast(Tracks::value_type& track,
                          Timestamp until,
                          std::vector<DeviceUpdate>& updates) const {
  auto& [device, entry] = track;
  while (entry.due < until) {
    auto estimate = entry.track.coast(entry.due);
    entry.due += options_.coasting_interval;
    if (estimate) {
      updates.push_back({device, *std::move(estimate)});
    }
    if (entry.track.state() == TrackState::kLost) {
      return false;
    }
  }
  return true;
}

void DeviceTracker::hear(const MacAddress& device,
                         std::span<const CsiFrame> frames,
                         std::vector<DeviceUpdate>& updates) {
  if (frames.empty()) {
    return;
  }
  auto found = tracks_.find(device);
  if (found != tracks_.end() && !coast(*found, frames.front().time, updates)) {
    tracks_.erase(found);
    found = tracks_.end();
  }
  if (found == tracks_.end()) {
    if (tracks_.size() >= options_.max_tracks) {
      ++refused_;
      return;
    }
    found = tracks_.emplace(device, Entry{Track(localizer_, space_, options_.track), {}}).first;
  }
  Entry& entry = found->second;
  const std::uint64_t refused_before = entry.track.out_of_order();
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    while (end < frames.size() && frames[end].time - frames[begin].time <= options_.moment) {
      ++end;
    }
    if (auto estimate = entry.track.hear(frames.subspan(begin, end - begin))) {
      entry.due = estimate->location.time + options_.track.coast_after;
      updates.push_back({device, *std::move(estimate)});
    }
    begin = end;
  }
  out_of_order_ += entry.track.out_of_order() - refused_before;
  if (!entry.track.state()) {
    tracks_.erase(found);
  }
}

void DeviceTracker::advance(Timestamp now, std::vector<DeviceUpdate>& updates) {
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    it = coast(*it, now, updates) ? std::next(it) : tracks_.erase(it);
  }
}

}  // namespace rayloc
