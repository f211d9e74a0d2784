// DeviceTracker: the tracks of all devices of one kind; a device is told by its address (METHODS
// B6), so frames are never assigned to a wrong track.
//
// A device's bursts are cut into moments in which a walker moves less than half a wavelength; each
// moment is a measurement, its frames of all access points together.
//
// A silent device's predicted position is stated at fixed times after its last frame, so that what
// is stated does not depend on how often advance() is called.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
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
#include "engine/track/track.h"

namespace rayloc {

struct DeviceTrackerOptions {
  TrackOptions track;
  Duration moment = std::chrono::milliseconds(30);
  // Between two predicted positions of a silent device.
  Duration coasting_interval = std::chrono::milliseconds(200);
  std::size_t max_tracks = 256;      // a flood of made-up addresses costs no more memory
  std::set<MacAddress> always = {};  // devices that are known: they get a track all the same
};

// moments = used + out_of_order + unusable + unexplained; begun = lost + tracks now.
struct TrackerCounters {
  std::uint64_t begun = 0;    // tracks
  std::uint64_t lost = 0;     // tracks
  std::uint64_t moments = 0;  // measurements given to tracks
  std::uint64_t used = 0;     // that led to an estimate; the others by MomentRefusal
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

// The frames of one device, in order of time.
struct DeviceBurst {
  MacAddress device;
  std::span<const CsiFrame> frames;
  // The device has not been silent since then, earlier bursts were left out; its first frame when
  // nothing is stated.
  std::optional<Timestamp> heard_since = std::nullopt;
  FrameDoubt doubt = {};
};

class DeviceTracker {
 public:
  DeviceTracker(std::shared_ptr<const Localizer> localizer, DeviceTrackerOptions options);

  // [burst]: an estimate for every moment of the burst. Devices are independent of each other, so
  // that the machine's cores share the bursts. REQUIRES: every burst is of another device.
  std::vector<std::vector<DeviceUpdate>> hear(std::span<const DeviceBurst> bursts);
  // The same of one, appended.
  void hear(const MacAddress& device,
            std::span<const CsiFrame> frames,
            std::vector<DeviceUpdate>& updates,
            std::optional<Timestamp> heard_since = std::nullopt,
            const FrameDoubt& doubt = {});

  // No frame before `now` comes any more: appends where the silent ones may be, forgets the lost.
  void advance(Timestamp now, std::vector<DeviceUpdate>& updates);

  // What was heard so far may have been wrong: each device may be anywhere, and is followed on.
  void forget_places();

  // Every track ends, for that reason: time may go back.
  void restart(const std::string& reason, std::vector<DeviceUpdate>& updates);

  // Whether it has a track of the device at all.
  bool has(const MacAddress& device) const { return tracks_.count(device) > 0; }
  // The same of one that was confirmed: one heard once may be anybody.
  bool follows(const MacAddress& device) const;
  // When the device that has been silent longest of those with a track was heard; `now` without
  // any.
  Timestamp heard_until(Timestamp now) const;
  std::size_t size() const { return tracks_.size(); }
  const TrackerCounters& counters() const { return counters_; }

 private:
  struct Entry {
    Track track;
    Timestamp due;  // of the next predicted position, if the device stays silent
  };
  using Tracks = std::map<MacAddress, Entry>;

  // States what is due before `until`; false when the track is lost.
  bool coast(Tracks::value_type& track, Timestamp until, std::vector<DeviceUpdate>& updates);
  // The track of a burst, coasted up to it; the end when there are too many.
  Tracks::iterator track_of(const DeviceBurst& burst, std::vector<DeviceUpdate>& updates);
  // What becomes of the track of one device, and of nothing else.
  TrackerCounters hear_moments(Tracks::value_type& track,
                               const DeviceBurst& burst,
                               std::vector<DeviceUpdate>& updates) const;
  void hear_moment(Tracks::value_type& track,
                   std::span<const CsiFrame> frames,
                   const FrameDoubt& doubt,
                   TrackerCounters& counters,
                   std::vector<DeviceUpdate>& updates) const;

  std::shared_ptr<const Localizer> localizer_;
  std::shared_ptr<const FreeSpace> space_;
  DeviceTrackerOptions options_;
  Tracks tracks_;
  TrackerCounters counters_;
};

}  // namespace rayloc
