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
#include <span>
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
  std::size_t max_tracks = 256;  // a flood of made-up addresses costs no more memory
};

struct DeviceUpdate {
  MacAddress device;
  FilteredEstimate estimate;
};

class DeviceTracker {
 public:
  DeviceTracker(std::shared_ptr<const Localizer> localizer, DeviceTrackerOptions options);

  // Appends an estimate for every moment of the burst. `frames`: of `device`, in order of time.
  void hear(const MacAddress& device,
            std::span<const CsiFrame> frames,
            std::vector<DeviceUpdate>& updates);

  // No frame before `now` comes any more: appends where the silent ones may be, forgets the lost.
  void advance(Timestamp now, std::vector<DeviceUpdate>& updates);

  std::size_t size() const { return tracks_.size(); }
  std::uint64_t out_of_order() const { return out_of_order_; }  // moments refused
  std::uint64_t refused() const { return refused_; }            // bursts beyond max_tracks

 private:
  struct Entry {
    Track track;
    Timestamp due;  // of the next predicted position, if the device stays silent
  };
  using Tracks = std::map<MacAddress, Entry>;

  // States what is due before `until`; false when the track is lost.
  bool coast(Tracks::value_type& track, Timestamp until, std::vector<DeviceUpdate>& updates) const;

  std::shared_ptr<const Localizer> localizer_;
  std::shared_ptr<const FreeSpace> space_;
  DeviceTrackerOptions options_;
  Tracks tracks_;
  std::uint64_t out_of_order_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace rayloc
