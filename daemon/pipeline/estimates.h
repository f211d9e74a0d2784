// Estimates: the results of an estimator, to be published.
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"

namespace rayloc {

struct Estimates {
  std::vector<Location> locations;
  std::vector<TrackEvent> events;
  std::vector<ZoneEvent> zone_events;
  std::uint64_t frames_left_out = 0;  // frames of the burst, left out for lack of time

  void clear() {
    locations.clear();
    events.clear();
    zone_events.clear();
    frames_left_out = 0;
  }
};

}  // namespace rayloc
