// SiteRuntime: the objects of one site while raylocd runs: its room, its estimators, its pipeline,
// its recorders, its names and zones, and their status. Objects shared by sites (sockets, HTTP, the
// guard, the log) belong to Process.
//
// Thread safety: one thread (main), unless stated otherwise.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/ownership/out_stage.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/ownership/standby_start.h"
#include "daemon/live/cluster/site_feed.h"
#include "daemon/live/config/config.h"
#include "daemon/live/health/loss_watch.h"
#include "daemon/live/health/readiness.h"
#include "daemon/live/health/saturation.h"
#include "daemon/live/health/status.h"
#include "daemon/live/output/site_output.h"
#include "daemon/live/service/estimators/site_estimators.h"
#include "daemon/live/service/sources/source_factory.h"
#include "daemon/messages/target_names.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/record/recorder_stage.h"
#include "daemon/pipeline/record/ring_snapshots.h"
#include "daemon/pipeline/shared/shared_threads.h"
#include "daemon/site/model/path_grid_files.h"
#include "engine/base/expected.h"

namespace rayloc {

class SiteRuntime {
 public:
  // Objects that the sites share.
  struct Surroundings {
    Timestamp started;                          // start time of the daemon
    std::shared_ptr<PathGridStore> path_grids;  // null: traced rooms are not stored
    std::shared_ptr<LimitedLog> limited_log;
    std::shared_ptr<SharedThreads> threads;  // of their pipelines
    CaptureRole* capture = nullptr;          // null: not a capture node
    std::shared_ptr<Broker> broker;          // null: not part of a cluster
    // Receives messages about a start for the operator, line by line.
    std::function<void(const std::string& line)> log;
  };

  // Reads the scene and prepares the room. No source is opened yet.
  static Expected<std::unique_ptr<SiteRuntime>> prepare(SiteSetup setup,
                                                        const Surroundings& surroundings);
  ~SiteRuntime();
  SiteRuntime(const SiteRuntime&) = delete;
  SiteRuntime& operator=(const SiteRuntime&) = delete;

  const SiteSetup& setup() const { return setup_; }
  // For a worker, before open(): it owns the site from now on, and continues from the end of the
  // previous owner. An Error if the results show another owner.
  Expected<void> claim(std::uint64_t generation);
  // For a worker, before open(): another one owns the site; this one is a standby from `along` on.
  // claim() after start() makes it the owner, and take_over() publishes the unpublished results.
  Expected<void> begin_standby(StandbyStart along);
  void take_over();
  // Comparison of its results with those of the owner; empty if it is no standby.
  std::optional<OutStage::Standby> standby() const;
  bool is_late() const { return along_ && along_->is_late; }
  // Generation of the claim with which the site is owned; 0: not owned.
  std::uint64_t generation() const { return start_.generation; }
  // Level of the load shedding of a worker (shed_rule.h); 0: none.
  std::uint32_t shed_level() const { return feed_ ? feed_->counters().shed_level : 0; }
  // For a worker: publishes the last results and gives the site back; no output follows.
  void give_back();
  // For a worker: reason why the site is not its own any more; empty while it is.
  std::string lost() const;
  // Options of its output; to be called before open(). `board`: read by its viewers; may be null.
  SiteOutput::Options output_options(std::shared_ptr<MessageBoard> board);
  // Existing objects that replace those that sources would open.
  struct Opened {
    // The socket that systemd bound with that name, "source-ID", which replaces the address of its
    // source; empty where there is none.
    std::function<std::optional<int>(const std::string& name)> take_socket;
    // The source that the same site had before a reload; null where there is none.
    std::function<std::unique_ptr<DatagramSource>(const SourceConfig& config)> take_source;
  };
  // Opens sources and recorders. `output` outlives this.
  Expected<void> open(const Opened& before, SiteOutput& output);
  void start();

  Pipeline& pipeline() { return *pipeline_; }
  // Ends all running threads without draining.
  void end();
  // Closing steps of its recorders and snapshots, after the pipeline has stopped.
  struct Closing {
    std::string stage;
    std::function<void()> finish;
  };
  std::vector<Closing> closings();
  // Names the stages of a pipeline that does not end, or of the results before it: those that do
  // not rest. If all of them rest, it waits for a thread that another site holds.
  std::string stuck_in_pipeline() const;

  // Every thread; this outlives the returned stages.
  std::vector<Stage> stages() const;
  // Applies the keys that a reload may change.
  void apply(const RecordConfig& record);
  // Begins to write the recent datagrams; the paths of the files. From any thread.
  Expected<std::vector<std::string>> snapshot();

  // For the heartbeat and for HTTP; from any thread once it is open.
  StatusMessages status(Timestamp now) const;
  // The part of ServiceHealth that belongs to this site; from any thread.
  ServiceHealth health() const;
  StatusSources& status_sources() { return status_; }
  // Null: no devices are located.
  DeviceEstimator* estimator() const { return estimators_->devices(); }
  const RoomModel* room() const { return estimators_->room(); }  // null: no target is located
  bool names_hashed() const { return names_->hashed(); }
  std::shared_ptr<Playback> playback() const { return recording_clock_.playback; }
  const BatchSender* sender() const { return sender_.get(); }  // null: not a capture node
  const RingSnapshots* ring_snapshots() const { return snapshots_of_rings_.get(); }

  // For the log.
  std::vector<std::string> source_descriptions() const;
  // Sources that have failed and recordings that could not be written, currently.
  std::vector<std::string> errors() const;
  // Notices about snapshots and chains since the last call.
  std::vector<std::string> notices();
  // Warnings about the calibration; the same warning once in ten minutes.
  std::vector<std::string> new_warnings();
  // Logs losses and notes them as a reason against readiness; about every second.
  void check_losses();

 private:
  SiteRuntime(SiteSetup setup, const Surroundings& surroundings);
  Expected<void> open_estimators();
  void describe_room();
  void check_site();
  Expected<void> open_sources(const Opened& before,
                              SiteOutput& output,
                              std::vector<SourceWorker::Input>& inputs);
  Expected<void> open_cluster(SiteOutput& output);
  Expected<void> open_feed(SiteOutput& output);
  Expected<void> subscribe_to_owner(SiteOutput& output, OutStage::Options options);
  Expected<void> restore_estimators(const std::shared_ptr<const Carried>& before);
  LocationSink& go_on(PipelineOptions& options);
  void add_ring(SourceWorker::Input& input);
  void open_snapshots();

  const SiteSetup setup_;
  const Surroundings surroundings_;
  LossWatch losses_;
  std::shared_ptr<TargetNames> names_;
  std::unique_ptr<SiteEstimators> estimators_;
  SiteLacks lacks_;  // none if no target is to be located
  RecordingClock recording_clock_;
  std::vector<std::unique_ptr<RecorderStage>> recorders_;
  std::vector<std::unique_ptr<DatagramRing>> rings_;
  std::unique_ptr<RingSnapshots> snapshots_of_rings_;    // null without rings
  std::shared_ptr<BatchSender> sender_;                  // null: not a capture node
  std::optional<StandbyStart> along_;                    // of a worker that was a standby
  std::unique_ptr<OwnerLog> log_;                        // of a worker, from claim() to open()
  SiteStart start_;                                      // as in `log_`
  std::unique_ptr<SiteFeed> feed_;                       // null: not a worker
  std::unique_ptr<LaterFrames> later_frames_;            // null: not a worker
  std::unique_ptr<OutStage> results_;                    // null: not a worker
  std::unique_ptr<Broker::Subscription> owner_records_;  // null: no standby
  std::unique_ptr<Pipeline> pipeline_;
  StatusSources status_;
  mutable std::mutex saturation_mutex_;
  Saturation saturation_;  // guarded by saturation_mutex_
  struct ReportedWarning {
    CalibrationWarning warning;
    std::chrono::steady_clock::time_point time;
  };
  std::vector<ReportedWarning> reported_warnings_;
};

}  // namespace rayloc
