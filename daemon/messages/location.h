// Location: an estimate passed from an estimator to a sink: the engine's LocationEstimate, its
// target, and additional data. It is converted to messages at the output (location_message.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"
#include "engine/track/filtered_estimate.h"

namespace rayloc {

enum class TargetKind : std::uint8_t { kDevice, kPerson };

struct Target {
  TargetKind kind = TargetKind::kDevice;
  std::string address = {};  // of a device, from TargetNames; empty: a person
  bool is_hashed = false;    // `address` is a hash
  std::optional<std::uint64_t> track = std::nullopt;
  std::string name = {};  // for people; may be empty
};

// Data shared by all locations of one method in one room.
struct LocationContext {
  std::string site;            // its name
  std::string scene_hash;      // hash of the room's scene
  std::string calibration_id;  // empty: not calibrated
  std::string method;
  Duration valid_for{};  // after the estimate's time
};

// Additional results of a tracker, besides the position.
struct Tracked {
  TrackState state = TrackState::kTentative;
  bool is_predicted = false;                     // from earlier bursts only
  std::optional<Vec3d> velocity = std::nullopt;  // [m/s]
};

struct ZoneProbability {
  std::string zone;  // its name
  double probability = 0.0;
};

struct Location {
  LocationEstimate estimate = {};
  Target target = {};
  LocationContext context = {};
  std::optional<Tracked> tracked = std::nullopt;  // absent: a snapshot
  std::vector<ZoneProbability> zones = {};        // in the order of the site

  bool is_filtered() const { return tracked.has_value(); }
};

Location filtered_location(const FilteredEstimate& estimate,
                           Target target,
                           LocationContext context);

}  // namespace rayloc
