// TrackEvent, ZoneEvent: events of tracks and in zones, passed from an estimator to a sink. They
// are converted to messages at the output (location_message.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/messages/location.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/track/filtered_estimate.h"

namespace rayloc {

struct TrackEvent {
  Target target;  // its track is stated
  TrackTransition transition;
  std::optional<Vec3d> position;  // [m], the last one available
};

enum class ZoneEventKind : std::uint8_t { kEntered, kLeft, kDwelled };

struct ZoneEvent {
  ZoneEventKind kind = ZoneEventKind::kEntered;
  Timestamp time;              // time of the estimate that decided it
  std::string zone;            // name of the zone
  Target target;               // the target concerned
  double probability = 0.0;    // of the target being inside, by its last estimate
  Duration dwell{};            // time since it entered; zero for an enter event
  std::string reason;          // reason for leaving; otherwise empty
  std::vector<Target> inside;  // targets inside after this event, in order of entry
};

}  // namespace rayloc
