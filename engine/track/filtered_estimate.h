// FilteredEstimate: the filtered position of a target and the state of its track (track.h).
#pragma once

#include <optional>
#include <string>

#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

enum class TrackState { kTentative, kConfirmed, kCoasting, kLost };

struct TrackTransition {
  Timestamp time;
  std::optional<TrackState> before;  // empty: the track begins
  TrackState after = TrackState::kTentative;
  std::string reason;
};

struct FilteredEstimate {
  LocationEstimate location;
  TrackState state = TrackState::kTentative;
  bool predicted = false;  // from earlier bursts only
  // [m/s], of the cloud that follows the target, otherwise over the last second; absent when
  // predicted, or when the bursts of that second span less than half of it.
  std::optional<Vec3d> velocity;
  double stationary = 0.0;  // probability
  std::optional<TrackTransition> transition;
};

}  // namespace rayloc
