// predict_site: predicts the accuracy in the room of a site, for a given traffic of its devices.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/predict/planned_room.h"
#include "daemon/lab/predict/prediction.h"
#include "daemon/lab/predict/proposals.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct SitePredictionOptions {
  PlannedRoomOptions plan;
  // `bandwidth_mhz`, `frames` and `progress` follow from the others and the site.
  PredictionOptions prediction;
  double step = 0.0;        // [m], between places; 0: for about sixty places
  std::size_t devices = 1;  // that share one channel
  double rate = 50.0;       // [1/s], frames that an access point receives from all devices
  double burst = 0.2;       // [s]

  // Expected number of frames of one device in a burst.
  double frames_per_burst() const { return rate * burst / static_cast<double>(devices); }
};

struct SitePrediction {
  std::shared_ptr<const RoomModel> room;  // as planned
  std::vector<Vec3d> places;
  PredictionOptions options;  // as used, without `progress`
  Prediction prediction;
  double received_share = 0.0;  // of bursts in which one device is received
};

// Returns an Error (kUsage) for a bandwidth that no frame has.
Expected<void> check_prediction(const SitePredictionOptions& options);

// Progress is in stage "predicting". Errors: as in check_prediction(), planned_room() and
// predict(); a `step` without a place in the room (kUsage). Thread-safe.
Expected<SitePrediction> predict_site(const Site& site,
                                      const SitePredictionOptions& options,
                                      const Observer& observer);

// proposals() for the same places and options. Progress is in stage "comparing".
Expected<std::vector<Proposal>> propose_changes(const SitePrediction& predicted,
                                                const ProposalOptions& which,
                                                const Observer& observer);

}  // namespace rayloc
