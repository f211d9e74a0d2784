// Estimates: the results of an estimator, to be published.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "daemon/messages/location.h"
#include "daemon/messages/target_event.h"

namespace rayloc {

struct ChainState;

struct Estimates {
  std::vector<Location> locations;
  std::vector<TrackEvent> events;
  std::vector<ZoneEvent> zone_events;
  std::uint64_t frames_left_out = 0;  // frames of the burst, left out for lack of time
  // State of the receive chains as of the burst, for the estimators that follow; null: not
  // estimated. Set for bursts of fixed transmitters only.
  std::shared_ptr<const std::vector<ChainState>> chains;

  void clear() {
    locations.clear();
    events.clear();
    zone_events.clear();
    frames_left_out = 0;
    chains.reset();
  }
};

}  // namespace rayloc
