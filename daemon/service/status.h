// The counters of all stages as the messages Heartbeat and SourceState.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/publisher_stage.h"
#include "daemon/pipeline/recorder_stage.h"

namespace rayloc {

// Where the numbers come from; everything outlives the calls of status_messages().
struct StatusSources {
  const Pipeline* pipeline = nullptr;
  const PublisherStage* publisher = nullptr;
  const DeviceEstimator* estimator = nullptr;
  std::vector<const RecorderStage*> recorders;
  std::vector<bool> live;  // by source: arrival stamps are of this machine's clock
  Timestamp started;
  std::string scene_hash;
  std::string calibration_id;
};

StatusMessages status_messages(const StatusSources& sources, Timestamp now);

}  // namespace rayloc
