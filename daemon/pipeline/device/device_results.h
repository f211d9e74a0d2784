// DeviceResults: converts the estimates of a method to locations and track events with the device's
// name, the number of its track and the context of its room.
//
// Thread safety: for one thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_names.h"
#include "daemon/pipeline/device/track_numbers.h"
#include "daemon/pipeline/estimates.h"
#include "daemon/site/model/site.h"
#include "engine/room/room_model.h"
#include "engine/track/device_tracker.h"

namespace rayloc {

class DeviceResults {
 public:
  struct Options {
    std::string method;                  // its name
    Duration valid_for{};                // after an estimate's time
    std::shared_ptr<TargetNames> names;  // not null
  };
  // `site` outlives this.
  DeviceResults(const Site& site, Options options) : site_(site), options_(std::move(options)) {}

  // Appends the snapshot of a burst.
  void append(LocationEstimate snapshot,
              const MacAddress& device,
              const RoomModel& room,
              Estimates& out) const;
  // Appends filtered estimates, and an event for each change of a track.
  void append(const std::vector<DeviceUpdate>& updates, const RoomModel& room, Estimates& out);

  // The numbers of tracks, as in TrackNumbers.
  void advance(Timestamp done) { numbers_.advance(done); }
  void go_on(NumberedTracks before, Timestamp done) {
    numbers_ = TrackNumbers(std::move(before), done);
  }
  NumberedTracks carried() const { return numbers_.carried(); }

 private:
  Target target_of(const MacAddress& device, Timestamp time) const;
  LocationContext context_of(const RoomModel& room) const;

  const Site& site_;
  const Options options_;
  TrackNumbers numbers_;
};

}  // namespace rayloc
