// Converts Location, TrackEvent and ZoneEvent to the public messages (proto/README.md).
//
// They are functions of their arguments: a replay gives the same bytes. `clock_ahead` is the
// lead of the external clock over event time: published times use that clock, ids use event
// time.
#pragma once

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/event.pb.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

// With NO_FIX there is no position or accuracy; `quality.no_fix_reason` states the reason.
v1::Location location_message(const Location& location, Duration clock_ahead = {});
// For a method that is compared with the site's own: event_id ends in its name.
v1::Location compared_message(const Location& location, Duration clock_ahead = {});

// REQUIRES: event.target.track.
v1::TrackEvent event_message(const TrackEvent& event, Duration clock_ahead = {});

v1::ZoneEvent event_message(const ZoneEvent& event, Duration clock_ahead = {});

v1::Target target_message(const Target& target);
Target target_of(const v1::Target& message);

}  // namespace rayloc
