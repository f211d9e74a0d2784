// TrackEvent, ZoneEvent: what happens to tracks and in zones, on its way from an estimator to a
// sink. Messages are made of them where they leave (location_message.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/publish/location.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/track/filtered_estimate.h"

namespace rayloc {

struct TrackEvent {
  Target target;  // its track is stated
  TrackTransition transition;
  std::optional<Vec3d> position;  // [m], the last known
};

enum class ZoneEventKind : std::uint8_t { kEntered, kLeft, kDwelled };

struct ZoneEvent {
  ZoneEventKind kind = ZoneEventKind::kEntered;
  Timestamp time;              // of the estimate that decided it
  std::string zone;            // its name
  Target target;               // who
  double probability = 0.0;    // that the target is inside, by its last estimate
  Duration dwell{};            // how long it has been inside; of one who entered zero
  std::string reason;          // why it left; else empty
  std::vector<Target> inside;  // after this event, in the order in which they came
};

}  // namespace rayloc
