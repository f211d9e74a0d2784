// PersonMethod: a method at work on people in one room, by the frames of one fixed transmitter.
//
// locate() is all that a method must have; tracks are of methods that have them.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/methods/method_options.h"
#include "engine/channel/csi_frame.h"
#include "engine/person/person_reference.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"
#include "engine/track/person_tracker.h"

namespace rayloc {

struct Training;

struct PersonMethodInput {
  std::shared_ptr<const RoomModel> room;
  PersonReference reference;
  MethodOptions options;
  // The numbers of tracks: first_number, first_number + number_step, ...
  std::uint64_t first_number = 1;
  std::uint64_t number_step = 1;
  Timestamp numbered_before = Timestamp::min();         // PersonTrackerOptions
  std::optional<Timestamp> last_moment = std::nullopt;  // PersonTrackerOptions
  std::shared_ptr<const Training> training = nullptr;   // of this method; null: nothing was learned
};

class PersonMethod {
 public:
  virtual ~PersonMethod() = default;

  // One estimate for each person, or one that says why nobody is seen. `frames`: of the reference's
  // transmitter, in order of time. `repeat`: as DeviceMethod::locate().
  virtual std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                               std::uint64_t repeat) const = 0;

  // Tracks, as PersonTracker has them.
  virtual void track(std::span<const CsiFrame> /*frames*/,
                     std::optional<Timestamp> /*heard_since*/,
                     std::vector<PersonUpdate>& /*updates*/) {}
  virtual void advance(Timestamp /*now*/, std::vector<PersonUpdate>& /*updates*/) {}
  virtual void restart(const std::string& /*reason*/, std::vector<PersonUpdate>& /*updates*/) {}
  // Of the track, or of the next one; nothing: there are no tracks.
  virtual std::optional<std::uint64_t> track_number() const { return std::nullopt; }
  virtual std::optional<Timestamp> last_moment() const { return std::nullopt; }  // looked at
  // When the person of the track was seen clearly last; `now` without one.
  virtual Timestamp seen_until(Timestamp now) const { return now; }
  virtual PersonTrackerCounters tracker_counters() const { return {}; }

 protected:
  PersonMethod() = default;
  PersonMethod(const PersonMethod&) = default;
  PersonMethod& operator=(const PersonMethod&) = default;
};

}  // namespace rayloc
