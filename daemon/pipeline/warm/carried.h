// Carried: the state that a successor of a pipeline needs because it cannot be recovered from the
// frames: assigned numbers, stays in zones, verdicts over many bursts, and starts of bursts.
//
// It is made at a *mark* of event time. All results for instants before `done` are published by
// then; the remaining state except this value is recovered by processing the last seconds again
// (warm_start.h). It is computed from results and frames only: the same frames give the same.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/device/track_numbers.h"
#include "daemon/pipeline/zones/zone_stays.h"
#include "engine/chains/chain_state.h"
#include "engine/monitor/calibration_monitor.h"

namespace rayloc {

struct Carried {
  // The people that a fixed transmitter detects.
  struct People {
    MacAddress transmitter;
    std::uint64_t number = 0;         // of the track, or of the next one
    std::optional<Timestamp> moment;  // last one processed, at the mark
  };
  // The last frame of a fixed transmitter that the calibration monitor has processed.
  struct Watched {
    MacAddress transmitter;
    Timestamp last;
  };

  Timestamp done = Timestamp::min();
  OpenBursts open;  // at the mark; every one starts at `done` or later
  // Last frame of the living track that has been silent longest: a successor that continues it
  // processes frames from before then. `done` if none is silent.
  Timestamp received = Timestamp::max();
  NumberedTracks devices;
  std::vector<People> people;  // by transmitter
  ZoneStays zones;
  std::vector<ChainState> chains;  // by access point, of those that differ from the calibration
  std::vector<CalibrationMonitor::MonitorState> calibration;  // by access point
  std::vector<Watched> watched;                               // by transmitter
};

}  // namespace rayloc
