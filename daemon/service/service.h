// Service: raylocd from its configuration to its last goodbye: opens everything, runs the pipeline
// and the publisher, and takes both down in order.
//
// Thread safety: one thread (main). It starts the others and joins them.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/publisher_stage.h"
#include "daemon/pipeline/recorder_stage.h"
#include "daemon/service/config.h"
#include "daemon/service/status.h"
#include "engine/base/expected.h"

namespace rayloc {

class Service {
 public:
  // Reads the scene, prepares the room, binds the publisher and opens the sources, in this order:
  // what can be wrong with files is known before a port is taken, and a datagram that arrives is
  // never left waiting for the room. Nothing runs yet.
  static Expected<std::unique_ptr<Service>> open(DaemonSetup setup);
  ~Service();

  // Returns when every thread runs.
  void start();

  // Drains what has been received for up to `patience`, publishes the last counters and the
  // goodbye, and joins every thread.
  void stop(const std::string& reason, std::chrono::milliseconds patience);

  // For the log, one line each.
  const std::string& endpoint() const { return publisher_->endpoint(); }
  std::vector<std::string> source_descriptions() const;
  // Sources that failed since the last call, and recordings that could not be written.
  std::vector<std::string> new_errors();
  // What speaks against the calibration; the same trouble once in ten minutes.
  std::vector<std::string> new_warnings();

 private:
  explicit Service(DaemonSetup setup) : setup_(std::move(setup)) {}
  Expected<void> open_sources(std::vector<SourceWorker::Input>& inputs);

  const DaemonSetup setup_;
  std::unique_ptr<DeviceEstimator> estimator_;
  std::unique_ptr<PublisherStage> publisher_;
  std::vector<std::unique_ptr<RecorderStage>> recorders_;
  std::unique_ptr<Pipeline> pipeline_;
  StatusSources status_;
  std::vector<std::string> told_errors_;
  struct ToldWarning {
    CalibrationWarning warning;
    std::chrono::steady_clock::time_point time;
  };
  std::vector<ToldWarning> told_warnings_;
};

}  // namespace rayloc
