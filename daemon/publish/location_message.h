// The engine's LocationEstimate as the public message Location (proto/README.md).
#pragma once

#include <string>

#include "engine/base/timestamp.h"
#include "engine/room/location_estimate.h"
#include "engine/track/track.h"
#include "rayloc/v1/event.pb.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

// What is said of a location besides the estimate itself.
struct LocationContext {
  v1::Target target;
  v1::Frame frame;
  v1::LocationKind kind = v1::LOCATION_KIND_SNAPSHOT;
  std::string method;
  Duration valid_for{};
};

// A function of its arguments: a replay gives the same bytes. With NO_FIX there is neither a
// position nor an accuracy, and `quality.no_fix_reason` says why.
v1::Location location_message(const LocationEstimate& estimate, const LocationContext& context);

// The same of the tracker: `context.kind` is LOCATION_KIND_FILTERED whatever it was.
v1::Location filtered_message(const FilteredEstimate& estimate, LocationContext context);

// The transition of the estimate's track. REQUIRES: estimate.transition; target.track is set.
v1::TrackEvent track_event(const FilteredEstimate& estimate, const v1::Target& target);

}  // namespace rayloc
