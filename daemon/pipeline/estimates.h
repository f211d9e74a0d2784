// Estimates: what an estimator says, to be published.
#pragma once

#include <vector>

#include "daemon/publish/location.h"
#include "daemon/publish/target_event.h"

namespace rayloc {

struct Estimates {
  std::vector<Location> locations;
  std::vector<TrackEvent> events;
  std::vector<ZoneEvent> zone_events;

  void clear() {
    locations.clear();
    events.clear();
    zone_events.clear();
  }
};

}  // namespace rayloc
