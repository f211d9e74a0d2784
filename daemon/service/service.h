// Service: raylocd from its configuration to its last goodbye: opens everything, runs the pipeline
// and the publisher, and takes both down in order.
//
// Thread safety: one thread (main). It starts the others and joins them.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/health/loss_watch.h"
#include "daemon/health/readiness.h"
#include "daemon/health/saturation.h"
#include "daemon/health/status.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/person_estimator.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/publisher_stage.h"
#include "daemon/pipeline/record/recorder_stage.h"
#include "daemon/pipeline/record/ring_snapshots.h"
#include "daemon/pipeline/zone_estimator.h"
#include "daemon/publish/last_messages.h"
#include "daemon/publish/message_board.h"
#include "daemon/publish/snapshot_server.h"
#include "daemon/publish/socket/connection_guard.h"
#include "daemon/publish/target_names.h"
#include "daemon/service/http_api.h"
#include "daemon/service/service_manager.h"
#include "daemon/service/source_factory.h"
#include "engine/base/expected.h"

namespace rayloc {

class Service {
 public:
  // Sees that its ports can be had, reads the scene, prepares the room, binds the publisher and
  // opens the sources, in this order: what can be wrong with files is known before a port is taken,
  // and a datagram that arrives is never left waiting for the room. Nothing runs yet.
  // A socket that systemd bound takes the place of the address in the configuration: "publish",
  // "snapshot", "http", and "source-ID" of a UDP source. `log`: what a person may want to know
  // meanwhile, line by line.
  static Expected<std::unique_ptr<Service>> open(
      DaemonSetup setup,
      PassedSockets& sockets,
      const std::function<void(const std::string& line)>& log);
  ~Service();

  // Returns when every thread has come round its loop once.
  void start();

  // What a reload may change. REQUIRES: `config` was validated.
  void apply(const DaemonConfig& config);
  void note_reload(bool successful, const ConfigValues* values);
  void note_stuck(std::vector<std::string> stages);

  // Begins to write what was received lately (ring_snapshots.h); the paths of the files. An Error
  // when there is nothing to write, or nowhere. From any thread.
  Expected<std::vector<std::string>> snapshot();

  // Every thread that serves somebody; the service outlives what it returns.
  std::vector<Stage> stages() const;
  // "3 sources, 3 receiving; 1234 datagrams, 0 lost; 56 fixes; 2 subscriptions"
  std::string status_line() const;

  // Drains what has been received, closes the recordings, publishes the last counters and the
  // goodbye, and joins every thread, all within `patience`. The stages that did not come back, none
  // as a rule: then the process must end without destroying this. No other stage waits for them.
  std::vector<std::string> stop(const std::string& reason, std::chrono::milliseconds patience);

  // Where HTTP is answered, "127.0.0.1:8480"; empty when it is not.
  std::string http_address() const;
  // For the log, one line each.
  const std::string& endpoint() const { return publisher_->endpoint(); }
  std::vector<std::string> source_descriptions() const;
  // Sources that failed since the last call, and recordings that could not be written.
  std::vector<std::string> new_errors();
  // Of those, what is over since the last call.
  std::vector<std::string> ended_errors();
  // What became of snapshots since the last call.
  std::vector<std::string> news();
  // What speaks against the calibration; the same trouble once in ten minutes.
  std::vector<std::string> new_warnings();
  // Whether it does what it is there for.
  Readiness readiness() const;
  // What is being lost, in the log and as a reason against being ready; to be called every second
  // or so.
  void log_losses();

 private:
  explicit Service(DaemonSetup setup) : setup_(std::move(setup)) {}
  Expected<void> check_resources(bool estimators_ready) const;
  Expected<void> open_publishing(PassedSockets& sockets);
  Expected<void> open_estimators(std::shared_ptr<PathGridStore> path_grids);
  void look_at_site();
  Expected<void> open_http(PassedSockets& sockets);
  ServiceHealth health() const;  // as of now
  std::vector<ExtraMetric> extra_metrics() const;
  std::vector<Stage> working_stages() const;
  std::string stuck_in_pipeline() const;
  HttpReply answer_snapshot();
  void add_ring(SourceWorker::Input& input);
  void open_snapshots();
  Expected<void> open_sources(PassedSockets& sockets, std::vector<SourceWorker::Input>& inputs);

  const DaemonSetup setup_;
  const std::shared_ptr<LimitedLog> limited_log_ = std::make_shared<LimitedLog>(log_event);
  LossWatch losses_{limited_log_};
  // Of threads that count no stage themselves; they outlive these.
  StageProgress guard_progress_;
  StageProgress snapshots_progress_;
  StageProgress http_progress_;
  std::shared_ptr<ConnectionGuard> guard_;
  std::shared_ptr<TargetNames> names_;
  std::unique_ptr<DeviceEstimator> estimator_;  // none with method "none"
  std::unique_ptr<PersonEstimator> people_;     // none without a reference of the empty room
  EstimatorList estimators_;                    // both
  std::unique_ptr<ZoneEstimator> zones_;        // over them
  std::unique_ptr<PublisherStage> publisher_;
  SiteLacks lacks_;  // none where nothing is to be located
  RecordingClock recording_clock_;
  std::vector<std::unique_ptr<RecorderStage>> recorders_;
  std::vector<std::unique_ptr<DatagramRing>> rings_;
  std::unique_ptr<RingSnapshots> snapshots_of_rings_;  // none where there are no rings
  std::unique_ptr<Pipeline> pipeline_;
  StatusSources status_;
  std::shared_ptr<LastMessages> last_messages_;
  std::shared_ptr<MessageBoard> message_board_;  // null without HTTP
  std::unique_ptr<SnapshotServer> snapshots_;
  mutable std::mutex health_mutex_;
  std::vector<std::string> stuck_stages_;  // guarded by health_mutex_
  Saturation saturation_;                  // guarded by health_mutex_
  std::string config_json_;                // guarded by health_mutex_
  bool reload_failed_ = false;             // guarded by health_mutex_; the last one
  Timestamp reloaded_{};                   // guarded by health_mutex_; when
  std::unique_ptr<HttpServer> http_;       // last: its handlers look at all the others
  std::vector<std::string> told_errors_;
  std::vector<std::string> ended_errors_;
  struct ToldWarning {
    CalibrationWarning warning;
    std::chrono::steady_clock::time_point time;
  };
  std::vector<ToldWarning> told_warnings_;
};

}  // namespace rayloc
