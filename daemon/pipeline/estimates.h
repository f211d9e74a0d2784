// Estimates: what an estimator says, to be published.
#pragma once

#include <vector>

#include "rayloc/v1/event.pb.h"
#include "rayloc/v1/location.pb.h"

namespace rayloc {

struct Estimates {
  std::vector<v1::Location> locations;
  std::vector<v1::TrackEvent> events;
  std::vector<v1::ZoneEvent> zone_events;

  void clear() {
    locations.clear();
    events.clear();
    zone_events.clear();
  }
};

}  // namespace rayloc
