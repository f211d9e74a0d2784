// Location, TrackEvent and ZoneEvent as the public messages (proto/README.md).
//
// They are functions of their arguments: a replay gives the same bytes. `clock_ahead` is what the
// clock of the outside is later than event time: times are told by that clock, ids are made of
// event time.
#pragma once

#include "daemon/publish/location.h"
#include "daemon/publish/target_event.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/event.pb.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

// With NO_FIX there is neither a position nor an accuracy, and `quality.no_fix_reason` says why.
v1::Location location_message(const Location& location, Duration clock_ahead = {});
// Of a method that is compared with the site's own: event_id ends in its name.
v1::Location compared_message(const Location& location, Duration clock_ahead = {});

// REQUIRES: event.target.track.
v1::TrackEvent event_message(const TrackEvent& event, Duration clock_ahead = {});

v1::ZoneEvent event_message(const ZoneEvent& event, Duration clock_ahead = {});

v1::Target target_message(const Target& target);
Target target_of(const v1::Target& message);

}  // namespace rayloc
