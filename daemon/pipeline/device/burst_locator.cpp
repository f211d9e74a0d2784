#include "daemon/pipeline/device/burst_locator.h"

#include <algorithm>
#include <string>
#include <utility>

#include "daemon/messages/topic.h"

namespace rayloc {
namespace {

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
  estimate.reason = "access point " + room.access_points[stamp.access_point].id + ": " +
                    describe(stamp) + ", and frames that share one give no position";
  return estimate;
}

}  // namespace

void BurstLocator::refuse(const Burst& burst,
                          const StuckStamp& stamp,
                          const RoomModel& room,
                          Estimates& out) {
  results_.append(without_position(burst, stamp, room), burst.transmitter, room, out);
}

void BurstLocator::snapshot(BurstWork& work) {
  results_.append(work.frames.empty() ? chains_.locate_coarsely(*work.burst, *work.room)
                                      : work.room->method->locate(work.frames, 0),
                  work.burst->transmitter,
                  work.room->room(),
                  *work.out);
  show_channel(work);
  work.has_snapshot = true;
}

void BurstLocator::begin(BurstWork& work) {
  const Burst& burst = *work.burst;
  const TrackCapability* tracks = work.room->method->tracks();
  if (is_behind(burst) && tracks != nullptr && !work.frames.empty()) {
    const std::size_t all = work.frames.size();
    work.frames = last_moment(work.frames);
    work.out->frames_left_out += all - work.frames.size();
  } else if (work.frames.empty() || snapshots_ == Snapshots::kAlways || tracks == nullptr ||
             !tracks->follows(burst.transmitter)) {
    snapshot(work);
  }
}

void BurstLocator::track(std::span<BurstWork> works, const std::vector<DeviceRoom>& rooms) {
  for (const DeviceRoom& room : rooms) {
    TrackCapability* tracks = room.method->tracks();
    if (tracks == nullptr) {
      continue;
    }
    std::vector<ReceivedBurst> bursts;
    std::vector<BurstWork*> received;
    for (BurstWork& work : works) {
      if (work.room == &room && !work.frames.empty()) {
        bursts.push_back({{work.burst->transmitter,
                           work.frames,
                           work.burst->received_since,
                           work.trust.chain_fault},
                          work.trust.withdrawals});
        received.push_back(&work);
      }
    }
    const auto updates = tracks->track(bursts);
    for (std::size_t i = 0; i < received.size(); ++i) {
      append(updates[i], *received[i]);
    }
  }
}

void BurstLocator::append(const std::vector<DeviceUpdate>& updates, BurstWork& work) {
  results_.append(updates, work.room->room(), *work.out);
  if (work.out->locations.size() == work.first) {
    if (is_behind(*work.burst)) {
      snapshot(work);
    }
  } else if (!work.has_snapshot) {
    show_channel(work);
  }
}

// Uses all frames that the last location was computed from: when a device moves, the others of its
// burst belong to other positions.
void BurstLocator::show_channel(const BurstWork& work) {
  const Location& location = work.out->locations.back();
  const std::shared_ptr<const ChannelCapability> channel = work.room->method->channel();
  if (channel == nullptr || !location.estimate.position || !channels_.is_wanted()) {
    return;
  }
  channels_.add({target_component(location.target),
                 location.target.name,
                 location.estimate.time,
                 *location.estimate.position,
                 {work.frames.begin(), work.frames.end()},
                 channel});
}

}  // namespace rayloc
