#include "daemon/lab/calibrate/device_bursts.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "daemon/lab/recordings/recorded_frames.h"
#include "daemon/site/model/room_model.h"

namespace rayloc {
namespace {

constexpr auto kBurst = std::chrono::milliseconds(200);  // as for a device tracked by raylocd

// Frames of one transmitter that form a burst.
using Frames = std::vector<CsiFrame>;

bool is_device(const Site& site, const MacAddress& transmitter) {
  const SiteTransmitter* stated = find_transmitter(site, transmitter);
  return stated == nullptr ? site.targets.track_unlisted : stated->role == TransmitterRole::kDevice;
}

// Ordered by end time.
std::vector<Frames> bursts_of(Frames frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  std::vector<Frames> bursts;
  std::map<MacAddress, std::size_t> open;
  for (CsiFrame& frame : frames) {
    const auto found = open.find(frame.transmitter);
    if (found == open.end() || frame.time - bursts[found->second].front().time >= kBurst) {
      open[frame.transmitter] = bursts.size();
      bursts.emplace_back();
    }
    bursts[open[frame.transmitter]].push_back(std::move(frame));
  }
  std::stable_sort(bursts.begin(), bursts.end(), [](const Frames& a, const Frames& b) {
    return a.back().time < b.back().time;
  });
  return bursts;
}

}  // namespace

Expected<DeviceBursts> read_device_bursts(const Site& site,
                                          const std::vector<CaptureArgument>& captures,
                                          std::vector<std::string>& notes) {
  DeviceBursts result;
  Frames frames;
  for (const RecordingArgument& recording : recordings_of(captures)) {
    const auto keep = [&](CsiFrame&& frame) {
      const SiteTransmitter* fixed = find_fixed_transmitter(site, frame.transmitter);
      const bool is_of_device = is_device(site, frame.transmitter);
      if (is_of_device || (fixed != nullptr && fixed->position)) {
        result.is_any_device |= is_of_device;
        result.receivers.insert(frame.access_point);
        frames.push_back(std::move(frame));
      }
    };
    RAYLOC_TRY(for_each_frame(site, recording, keep, notes));
  }
  result.bursts = bursts_of(std::move(frames));
  return result;
}

Expected<std::shared_ptr<const Localizer>> device_localizer(const Site& site, RoomModel room) {
  room.device = unlisted_device(site);
  auto localizer = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
  RAYLOC_TRY(localizer);
  return std::make_shared<const Localizer>(*std::move(localizer));
}

}  // namespace rayloc
