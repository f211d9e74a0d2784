// DeviceTracker: tracks of all devices of one kind. A device is identified by its address (METHODS
// B6), so frames are never assigned to a wrong track.
//
// Bursts of a device are cut into moments in which a walker moves less than half a wavelength. Each
// moment is one measurement with the frames of all access points.
//
// The predicted position of a silent device is reported at fixed times after its last frame, so
// that the output does not depend on how often advance() is called.
//
// Thread safety: use from one thread only.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/localize/localizer.h"
#include "engine/track/cloud_room.h"
#include "engine/track/track.h"

namespace rayloc {

struct DeviceTrackerOptions {
  TrackOptions track;
  Duration moment = std::chrono::milliseconds(30);
  // Time between two predicted positions of a silent device.
  Duration coasting_interval = std::chrono::milliseconds(200);
  std::size_t max_tracks = 256;      // bounds the memory that a flood of made-up addresses can take
  std::set<MacAddress> always = {};  // known devices: they get a track regardless of max_tracks
};

// moments = used + out_of_order + unusable + unexplained; begun = lost + tracks now.
struct TrackerCounters {
  std::uint64_t begun = 0;    // tracks
  std::uint64_t lost = 0;     // tracks
  std::uint64_t moments = 0;  // measurements given to tracks
  std::uint64_t used = 0;     // moments that led to an estimate; the others by MomentRefusal
  std::uint64_t out_of_order = 0;
  std::uint64_t unusable = 0;
  std::uint64_t unexplained = 0;
  std::uint64_t refused = 0;  // bursts beyond DeviceTrackerOptions::max_tracks

  TrackerCounters& operator+=(const TrackerCounters& other);
};

struct DeviceUpdate {
  MacAddress device;
  FilteredEstimate estimate;
};

// Frames of one device, in order of time.
struct DeviceBurst {
  MacAddress device;
  std::span<const CsiFrame> frames;
  // The device has not been silent since this time although earlier bursts were left out. Without a
  // value: the time of its first frame.
  std::optional<Timestamp> received_since = std::nullopt;
  FrameFault fault = {};
};

class DeviceTracker {
 public:
  DeviceTracker(std::shared_ptr<const Localizer> localizer, DeviceTrackerOptions options);

  // [burst]: an estimate for every moment of the burst. Devices are independent of each other, so
  // bursts are processed in parallel. REQUIRES: every burst is from a different device.
  std::vector<std::vector<DeviceUpdate>> receive(std::span<const DeviceBurst> bursts);
  // As above for one device; the updates are appended.
  void receive(const MacAddress& device,
               std::span<const CsiFrame> frames,
               std::vector<DeviceUpdate>& updates,
               std::optional<Timestamp> received_since = std::nullopt,
               const FrameFault& fault = {});

  // True for a device with frames before `now` that are still to be processed: it is not silent.
  using IsWaiting = std::function<bool(const MacAddress& device)>;
  // No frame before `now` will arrive, except of devices that wait: appends predictions of silent
  // devices, removes lost tracks.
  void advance(Timestamp now, std::vector<DeviceUpdate>& updates, const IsWaiting& is_waiting = {});

  // Earlier bursts may have been wrong: each device may be anywhere, and its track continues.
  void forget_places();

  // Ends every track with this reason, since time may go back.
  void restart(const std::string& reason, std::vector<DeviceUpdate>& updates);

  // True if the device has a track.
  bool has(const MacAddress& device) const { return tracks_.count(device) > 0; }
  // True if the device has a confirmed track: a single burst may come from any sender.
  bool follows(const MacAddress& device) const;
  // Time of the last usable burst of the tracked device that has been silent longest; `now` without
  // tracks.
  Timestamp received_until(Timestamp now) const;
  std::size_t size() const { return tracks_.size(); }
  std::size_t in_clouds() const;  // tracks that a cloud follows; for tests
  const TrackerCounters& counters() const { return counters_; }

 private:
  struct Entry {
    Track track;
    Timestamp due;  // time of the next predicted position, if the device stays silent
  };
  using Tracks = std::map<MacAddress, Entry>;

  // Appends the predictions due before `until`; false when the track is lost.
  bool coast(Tracks::value_type& track, Timestamp until, std::vector<DeviceUpdate>& updates);
  // Track of a burst, predicted up to the burst; end() when there are too many tracks.
  Tracks::iterator track_of(const DeviceBurst& burst, std::vector<DeviceUpdate>& updates);
  // Updates the track of one device and no other state.
  TrackerCounters receive_moments(Tracks::value_type& track,
                                  const DeviceBurst& burst,
                                  std::vector<DeviceUpdate>& updates) const;
  void receive_moment(Tracks::value_type& track,
                      std::span<const CsiFrame> frames,
                      const FrameFault& fault,
                      TrackerCounters& counters,
                      std::vector<DeviceUpdate>& updates) const;

  std::shared_ptr<const Localizer> localizer_;
  std::shared_ptr<const FreeSpace> space_;
  std::shared_ptr<const CloudRoom> cloud_room_;  // null: the grid follows every device
  DeviceTrackerOptions options_;
  Tracks tracks_;
  TrackerCounters counters_;
};

}  // namespace rayloc
