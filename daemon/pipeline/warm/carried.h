// Carried: what a successor of a pipeline has to be told, because the frames that it hears cannot
// tell: numbers that were given, stays in zones, verdicts over many bursts, and where bursts start.
//
// It is made at a *mark* of event time. Everything that refers to an instant before `done` has been
// said by then; of what is left, all but this value comes back by listening to the last seconds
// again (warm_start.h). Values, made of what was said and heard: the same frames give the same.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/track_numbers.h"
#include "daemon/pipeline/zones/zone_stays.h"
#include "engine/chains/chain_state.h"
#include "engine/monitor/calibration_monitor.h"

namespace rayloc {

struct Carried {
  // The people whom a fixed transmitter sees.
  struct People {
    MacAddress transmitter;
    std::uint64_t number = 0;         // of the track, or of the next one
    std::optional<Timestamp> moment;  // that was looked at last, at the mark
  };
  // The last frame of a fixed transmitter that the calibration's watch has looked at.
  struct Watched {
    MacAddress transmitter;
    Timestamp last;
  };

  Timestamp done = Timestamp::min();
  OpenBursts open;  // at the mark; every one starts at `done` or later
  // Of the living tracks, when the one that has been silent longest was heard: a successor that
  // knows it listens again from before then. `done` where none is silent.
  Timestamp heard = Timestamp::max();
  NumberedTracks devices;
  std::vector<People> people;  // by transmitter
  ZoneStays zones;
  std::vector<ChainState> chains;  // by access point, of those that are not as calibrated
  std::vector<CalibrationMonitor::Told> calibration;  // by access point
  std::vector<Watched> watched;                       // by transmitter
};

}  // namespace rayloc
