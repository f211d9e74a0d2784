// SiteRuntime: what belongs to one site while raylocd runs: its room, its estimators, its pipeline,
// its recorders, and what is told of them. What sites share (sockets, HTTP, the guard) is
// Service's.
//
// Thread safety: one thread (main), where nothing else is said.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/cluster/capture_role.h"
#include "daemon/cluster/ownership/out_stage.h"
#include "daemon/cluster/ownership/owner_log.h"
#include "daemon/cluster/ownership/standby_start.h"
#include "daemon/cluster/site_feed.h"
#include "daemon/config/config.h"
#include "daemon/health/loss_watch.h"
#include "daemon/health/readiness.h"
#include "daemon/health/saturation.h"
#include "daemon/health/status.h"
#include "daemon/pipeline/output/site_output.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/record/recorder_stage.h"
#include "daemon/pipeline/record/ring_snapshots.h"
#include "daemon/publish/target_names.h"
#include "daemon/service/estimators/site_estimators.h"
#include "daemon/service/sources/source_factory.h"
#include "daemon/site/path_grid_files.h"
#include "engine/base/expected.h"

namespace rayloc {

class SiteRuntime {
 public:
  // What sites share.
  struct Surroundings {
    Timestamp started;                          // when the daemon did
    std::shared_ptr<PathGridStore> path_grids;  // null: traced rooms are not kept
    std::shared_ptr<LimitedLog> limited_log;
    CaptureRole* capture = nullptr;  // null: this is no capture node
    std::shared_ptr<Broker> broker;  // null: this is no machine of a cluster
    // What a person may want to know of a start, line by line.
    std::function<void(const std::string& line)> log;
  };

  // Reads the scene and prepares the room. Nothing is opened yet.
  static Expected<std::unique_ptr<SiteRuntime>> prepare(SiteSetup setup,
                                                        const Surroundings& surroundings);
  ~SiteRuntime();
  SiteRuntime(const SiteRuntime&) = delete;
  SiteRuntime& operator=(const SiteRuntime&) = delete;

  const SiteSetup& setup() const { return setup_; }
  // Of a worker, before open(): it owns the site from now on, and goes on where the owner before it
  // has ended. An Error where the results say that another one owns it.
  Expected<void> claim(std::uint64_t generation);
  // Of a worker, before open(): another one owns the site, and this one computes along, as from
  // there. claim() after start() makes it the owner, and speak() has it say what nobody has said.
  Expected<void> stand_by(StandbyStart along);
  void speak();
  // How what it computes compares with what the owner says; nothing where it does not stand by.
  std::optional<OutStage::Standby> standby() const;
  bool is_late() const { return along_ && along_->is_late; }
  // Of the claim with which it is owned; 0: it is not.
  std::uint64_t generation() const { return start_.generation; }
  // Of what a worker leaves out of it (shed_rule.h); 0: nothing.
  std::uint32_t shed_level() const { return feed_ ? feed_->counters().shed_level : 0; }
  // Of a worker: says its last words and gives the site back; nothing is said afterwards.
  void give_back();
  // Of a worker: why the site is not its own any more; empty while it is.
  std::string lost() const;
  // How it is published; to be called before open(). `board`: where its viewers look; may be null.
  SiteOutput::Options output_options(std::shared_ptr<MessageBoard> board);
  // What there is already of what sources would open.
  struct Opened {
    // The socket that systemd bound of that name, "source-ID", which takes the place of the address
    // of its source; nothing where there is none.
    std::function<std::optional<int>(const std::string& name)> take_socket;
    // The source that the same site had before a reload; null where there is none.
    std::function<std::unique_ptr<DatagramSource>(const SourceConfig& config)> take_source;
  };
  // Opens sources and recorders. `output` outlives this.
  Expected<void> open(const Opened& before, SiteOutput& output);
  void start();

  Pipeline& pipeline() { return *pipeline_; }
  // Ends every thread without draining, as far as there are any.
  void end();
  // Of its recorders and snapshots, after the pipeline has stopped.
  struct Closing {
    std::string stage;
    std::function<void()> finish;
  };
  std::vector<Closing> closings();
  // Which threads of the pipeline have not ended: one that has rests, and so does an estimation
  // that waits; but the sources whose frames it waits for have ended then.
  std::string stuck_in_pipeline() const;

  // Every thread; this outlives what it returns.
  std::vector<Stage> stages() const;
  // What a reload may change.
  void apply(const RecordConfig& record);
  // Begins to write what was received lately; the paths of the files. From any thread.
  Expected<std::vector<std::string>> snapshot();

  // For the heartbeat and for HTTP; from any thread once it is open.
  StatusMessages status(Timestamp now) const;
  // What of ServiceHealth is of this site; from any thread.
  ServiceHealth health() const;
  StatusSources& status_sources() { return status_; }
  // Null: no devices are located.
  DeviceEstimator* estimator() const { return estimators_->devices(); }
  const RoomModel* room() const { return estimators_->room(); }  // null: nothing is located
  bool names_hashed() const { return names_->hashed(); }
  std::shared_ptr<Playback> playback() const { return recording_clock_.playback; }
  const BatchSender* sender() const { return sender_.get(); }  // null: no capture node
  const RingSnapshots* ring_snapshots() const { return snapshots_of_rings_.get(); }

  // For the log.
  std::vector<std::string> source_descriptions() const;
  // Sources that have failed and recordings that could not be written, as of now.
  std::vector<std::string> errors() const;
  // What became of snapshots and of chains since the last call.
  std::vector<std::string> news();
  // What speaks against the calibration; the same trouble once in ten minutes.
  std::vector<std::string> new_warnings();
  // What is being lost, in the log and as a reason against being ready; every second or so.
  void look_for_losses();

 private:
  SiteRuntime(SiteSetup setup, const Surroundings& surroundings);
  Expected<void> open_estimators();
  void describe_room();
  void look_at_site();
  Expected<void> open_sources(const Opened& before,
                              SiteOutput& output,
                              std::vector<SourceWorker::Input>& inputs);
  Expected<void> open_cluster(SiteOutput& output);
  Expected<void> open_feed(SiteOutput& output);
  Expected<void> hear_owner(SiteOutput& output, OutStage::Options options);
  Expected<void> tell_estimators(const std::shared_ptr<const Carried>& before);
  LocationSink& go_on(PipelineOptions& options);
  void add_ring(SourceWorker::Input& input);
  void open_snapshots();

  const SiteSetup setup_;
  const Surroundings surroundings_;
  LossWatch losses_;
  std::shared_ptr<TargetNames> names_;
  std::unique_ptr<SiteEstimators> estimators_;
  SiteLacks lacks_;  // none where nothing is to be located
  RecordingClock recording_clock_;
  std::vector<std::unique_ptr<RecorderStage>> recorders_;
  std::vector<std::unique_ptr<DatagramRing>> rings_;
  std::unique_ptr<RingSnapshots> snapshots_of_rings_;  // none where there are no rings
  std::shared_ptr<BatchSender> sender_;                // null: this is no capture node
  std::optional<StandbyStart> along_;                  // of a worker that has stood by
  std::unique_ptr<OwnerLog> log_;                      // of a worker, from claim() to open()
  SiteStart start_;                                    // as `log_` has it
  std::unique_ptr<SiteFeed> feed_;                     // null: this is no worker
  std::unique_ptr<LaterFrames> later_frames_;          // null: this is no worker
  std::unique_ptr<OutStage> results_;                  // null: this is no worker
  std::unique_ptr<Broker::Subscription> owner_words_;  // null: it does not stand by
  std::unique_ptr<Pipeline> pipeline_;
  StatusSources status_;
  mutable std::mutex saturation_mutex_;
  Saturation saturation_;  // guarded by saturation_mutex_
  struct ToldWarning {
    CalibrationWarning warning;
    std::chrono::steady_clock::time_point time;
  };
  std::vector<ToldWarning> told_warnings_;
};

}  // namespace rayloc
