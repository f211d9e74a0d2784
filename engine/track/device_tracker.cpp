#include "engine/track/device_tracker.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/track/searched_cells.h"

namespace rayloc {
namespace {

// Time offset of the moments at which a target is searched for in the whole room.
Duration phase_of(const MacAddress& address) {
  const auto steps = static_cast<int>(std::hash<MacAddress>()(address) % 100);
  return kWholeRoomPeriod * steps / 100;
}

std::shared_ptr<const CloudRoom> cloud_room_of(const TrackOptions& options,
                                               const std::shared_ptr<const Localizer>& localizer,
                                               const std::shared_ptr<const FreeSpace>& space) {
  return options.uses_cloud && !options.is_exhaustive ? make_cloud_room(localizer, space) : nullptr;
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
      space_(std::make_shared<const FreeSpace>(make_free_space(*localizer_))),
      cloud_room_(cloud_room_of(options.track, localizer_, space_)),
      options_(std::move(options)) {}

bool DeviceTracker::coast(Tracks::value_type& track,
                          Timestamp until,
                          std::vector<DeviceUpdate>& updates) {
  auto& [device, entry] = track;
  while (entry.due < until) {
    auto estimate = entry.track.coast(entry.due);
    entry.track.compact();
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

void DeviceTracker::receive_moment(Tracks::value_type& track,
                                   std::span<const CsiFrame> frames,
                                   const FrameFault& fault,
                                   TrackerCounters& counters,
                                   std::vector<DeviceUpdate>& updates) const {
  auto& [device, entry] = track;
  const bool begins = !entry.track.state();
  ++counters.moments;
  auto estimate = entry.track.receive(frames, fault);
  if (estimate) {
    ++counters.used;
    counters.begun += begins ? 1U : 0U;
    entry.due = estimate->location.time + options_.track.coast_after;
    updates.push_back({device, *std::move(estimate)});
    return;
  }
  switch (estimate.error()) {
    case MomentRefusal::kOutOfOrder:
      ++counters.out_of_order;
      break;
    case MomentRefusal::kUnusable:
      ++counters.unusable;
      break;
    case MomentRefusal::kUnexplained:
      ++counters.unexplained;
      break;
  }
}

TrackerCounters DeviceTracker::receive_moments(Tracks::value_type& track,
                                               const DeviceBurst& burst,
                                               std::vector<DeviceUpdate>& updates) const {
  TrackerCounters counters;
  const std::span<const CsiFrame> frames = burst.frames;
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    while (end < frames.size() && frames[end].time - frames[begin].time <= options_.moment) {
      ++end;
    }
    receive_moment(track, frames.subspan(begin, end - begin), burst.fault, counters, updates);
    begin = end;
  }
  track.second.track.compact();
  return counters;
}

DeviceTracker::Tracks::iterator DeviceTracker::track_of(const DeviceBurst& burst,
                                                        std::vector<DeviceUpdate>& updates) {
  auto found = tracks_.find(burst.device);
  if (found != tracks_.end() &&
      !coast(*found, burst.received_since.value_or(burst.frames.front().time), updates)) {
    tracks_.erase(found);
    found = tracks_.end();
  }
  if (found == tracks_.end()) {
    if (tracks_.size() >= options_.max_tracks && options_.always.count(burst.device) == 0) {
      ++counters_.refused;
      return found;
    }
    Track track(localizer_,
                space_,
                options_.track,
                phase_of(burst.device),
                CloudSource{cloud_room_, std::hash<MacAddress>()(burst.device)});
    found = tracks_.emplace(burst.device, Entry{std::move(track), {}}).first;
  }
  return found;
}

std::vector<std::vector<DeviceUpdate>> DeviceTracker::receive(std::span<const DeviceBurst> bursts) {
  std::vector<std::vector<DeviceUpdate>> updates(bursts.size());
  std::vector<Tracks::iterator> tracks;
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    tracks.push_back(bursts[i].frames.empty() ? tracks_.end() : track_of(bursts[i], updates[i]));
  }
  std::vector<TrackerCounters> counters(bursts.size());
  parallel_for(bursts.size(), 1, [&](std::size_t i) {
    if (tracks[i] != tracks_.end()) {
      counters[i] = receive_moments(*tracks[i], bursts[i], updates[i]);
    }
  });
  for (std::size_t i = 0; i < bursts.size(); ++i) {
    counters_ += counters[i];
    if (tracks[i] != tracks_.end() && !tracks[i]->second.track.state()) {
      tracks_.erase(tracks[i]);
    }
  }
  return updates;
}

void DeviceTracker::receive(const MacAddress& device,
                            std::span<const CsiFrame> frames,
                            std::vector<DeviceUpdate>& updates,
                            std::optional<Timestamp> received_since,
                            const FrameFault& fault) {
  const DeviceBurst burst{device, frames, received_since, fault};
  auto received = receive(std::span(&burst, 1));
  std::move(received.front().begin(), received.front().end(), std::back_inserter(updates));
}

bool DeviceTracker::follows(const MacAddress& device) const {
  const auto found = tracks_.find(device);
  return found != tracks_.end() && found->second.track.state() != TrackState::kTentative;
}

std::size_t DeviceTracker::in_clouds() const {
  return static_cast<std::size_t>(
      std::count_if(tracks_.begin(), tracks_.end(), [](const auto& one) {
        return one.second.track.is_in_cloud();
      }));
}

Timestamp DeviceTracker::received_until(Timestamp now) const {
  for (const auto& [device, entry] : tracks_) {
    now = std::min(now, entry.track.received());
  }
  return now;
}

void DeviceTracker::forget_places() {
  for (auto& [device, entry] : tracks_) {
    entry.track.forget_place();
  }
}

void DeviceTracker::restart(const std::string& reason, std::vector<DeviceUpdate>& updates) {
  for (auto& [device, entry] : tracks_) {
    updates.push_back({device, entry.track.end(reason)});
    ++counters_.lost;
  }
  tracks_.clear();
}

void DeviceTracker::advance(Timestamp now,
                            std::vector<DeviceUpdate>& updates,
                            const IsWaiting& is_waiting) {
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    const bool continues = (is_waiting && is_waiting(it->first)) || coast(*it, now, updates);
    it = continues ? std::next(it) : tracks_.erase(it);
  }
}

}  // namespace rayloc
