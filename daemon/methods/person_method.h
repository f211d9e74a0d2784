// PersonMethod: a method instance for people in one room, using one fixed transmitter's frames.
//
// Every method must implement locate(); tracks are optional.
//
// Thread safety: single-threaded.
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
  std::shared_ptr<const Training> training = nullptr;   // for this method; null: untrained
};

class PersonMethod {
 public:
  virtual ~PersonMethod() = default;

  // One estimate for each person, or one that states why no person is located. `frames`: from the
  // reference's transmitter, in order of time. `repeat`: as in DeviceMethod::locate().
  virtual std::vector<LocationEstimate> locate(std::span<const CsiFrame> frames,
                                               std::uint64_t repeat) const = 0;

  // Tracks, as in PersonTracker.
  virtual void track(std::span<const CsiFrame> /*frames*/,
                     std::optional<Timestamp> /*received_since*/,
                     std::vector<PersonUpdate>& /*updates*/) {}
  virtual void advance(Timestamp /*now*/, std::vector<PersonUpdate>& /*updates*/) {}
  virtual void restart(const std::string& /*reason*/, std::vector<PersonUpdate>& /*updates*/) {}
  // Number of the track, or of the next one; empty: no tracks.
  virtual std::optional<std::uint64_t> track_number() const { return std::nullopt; }
  virtual std::optional<Timestamp> last_moment() const { return std::nullopt; }  // last evaluated
  // Last time when the tracked person was clearly observed; `now` without a track.
  virtual Timestamp seen_until(Timestamp now) const { return now; }
  virtual PersonTrackerCounters tracker_counters() const { return {}; }

 protected:
  PersonMethod() = default;
  PersonMethod(const PersonMethod&) = default;
  PersonMethod& operator=(const PersonMethod&) = default;
};

}  // namespace rayloc
