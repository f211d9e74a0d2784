// Preprocesses one burst for the published method: a measurement for each access point, or link,
// with usable frames.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/paper/csi_loss.h"
#include "engine/room/location_estimate.h"
#include "engine/room/preprocess_burst.h"
#include "engine/room/room_model.h"

namespace rayloc::paper {

// Source: has an `access_point` of the room. Measurement: constructed from a pointer to its source,
// the burst's h and its observables. `estimate` receives counts, times and warnings. REQUIRES:
// frames not empty.
template <typename Measurement, typename Source>
std::vector<Measurement> listen(const RoomModel& room,
                                const std::vector<Source>& sources,
                                std::span<const CsiFrame> frames,
                                const BurstOptions& options,
                                const CsiLoss& csi_loss,
                                LocationEstimate& estimate) {
  std::vector<Measurement> measured;
  ObservationTally tally;
  for (const Source& source : sources) {
    auto burst = preprocess_burst(room, source.access_point, frames, options, estimate.warnings);
    if (burst) {
      tally.add(room.access_points[source.access_point], *burst);
      auto observables = csi_loss.observe(burst->h);
      measured.push_back({&source, std::move(burst->h), std::move(observables)});
    }
  }
  tally.fill(frames, estimate);
  return measured;
}

}  // namespace rayloc::paper
