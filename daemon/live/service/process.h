// Process: raylocd from its configuration to its final goodbye: opens the parts that all sites
// share (sockets, publisher, HTTP, guard, log, membership of a cluster), starts and ends the sites
// (SiteRuntime), and closes everything in order.
//
// Thread safety: one thread (main). It starts the others and joins them.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "capture/transport/file_descriptor.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/gateway_role.h"
#include "daemon/live/cluster/operate/replica_watch.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/cluster/ownership/overload_rule.h"
#include "daemon/live/config/config.h"
#include "daemon/live/health/loss_watch.h"
#include "daemon/live/health/readiness.h"
#include "daemon/live/http/metrics.h"
#include "daemon/live/machine/process_load.h"
#include "daemon/live/output/publisher_stage.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "daemon/live/service/http_api.h"
#include "daemon/live/service/process_health.h"
#include "daemon/live/service/service_manager.h"
#include "daemon/live/service/shutdown.h"
#include "daemon/live/service/site/site_preparation.h"
#include "daemon/live/service/site/site_runtime.h"
#include "daemon/live/service/site/site_set.h"
#include "daemon/live/service/site/standby_audits.h"
#include "daemon/live/service/sources/handed_sources.h"
#include "daemon/messages/last_messages.h"
#include "daemon/pipeline/record/system_now.h"
#include "engine/base/expected.h"

namespace rayloc {

class Process {
 public:
  // Checks that its ports are available, reads the scene, prepares the room, binds the publisher
  // and opens the sources, in this order: errors in files are found before a port is bound, and no
  // arriving datagram waits for the preparation of the room. No thread runs yet.
  // A socket that systemd bound replaces the address in the configuration: "publish", "snapshot",
  // "http", and "source-ID" of a UDP source. `log`: receives progress messages for the operator,
  // line by line.
  static Expected<std::unique_ptr<Process>> open(
      DaemonSetup setup,
      PassedSockets& sockets,
      const std::function<void(const std::string& line)>& log);
  ~Process();

  // Returns when every thread has completed its loop once.
  void start();

  // Applies the keys that a reload may change. REQUIRES: `config` was validated.
  void apply(const DaemonConfig& config);
  // With [[site]]: ends the sites that were removed, and begins to prepare those that are new, that
  // are among `changed`, or whose files have changed. The others are not touched, and one whose
  // files cannot be used continues as it was. REQUIRES: no site is being prepared.
  void reload_sites(std::vector<SiteSetup> setups, const std::set<std::string>& changed);
  bool preparing_sites() const { return preparation_ != nullptr; }
  // True if the map's editor has written files of a site since the last call.
  bool take_reload_request() { return reload_wanted_.exchange(false); }
  // Starts the sites that are prepared by now, and those that were claimed; true if stages() has
  // changed.
  bool tend_sites();
  // Interval between two calls of tend_sites().
  std::chrono::milliseconds tend_period() const;
  RunningSetup running() const;
  void note_reload(bool successful, const ConfigValues* values);
  void note_stuck(std::vector<std::string> stages);

  // Begins to write the datagrams of the last time (ring_snapshots.h); the paths of the files. An
  // Error if there are no datagrams or no folder. From any thread.
  Expected<std::vector<std::string>> snapshot();

  // Every thread that provides a service, those of sites for which it is a standby, and every
  // shared one that a site which did not end still holds. Valid until tend_sites() or
  // reload_sites().
  std::vector<Stage> stages() const;
  // "3 sources, 3 receiving; 1234 datagrams, 0 lost; 56 fixes; 2 subscriptions"
  std::string status_line() const;

  // Drains the received data, closes the recordings, publishes the last counters and the goodbye,
  // and joins every thread, all within `patience`. Returns the stages that did not return, also of
  // sites that ended earlier, normally none: otherwise the process must end without destroying
  // this. No other stage waits for them.
  std::vector<std::string> stop(const std::string& reason, std::chrono::milliseconds patience);

  // Address of the HTTP server, "127.0.0.1:8480"; empty without one.
  std::string http_address() const;
  // For the log, one line each.
  const std::string& endpoint() const { return publisher_->endpoint(); }
  std::vector<std::string> source_descriptions() const;
  // Sources that failed since the last call, and recordings that could not be written.
  std::vector<std::string> new_errors();
  // Those of them that have ended since the last call.
  std::vector<std::string> ended_errors();
  // Completed and failed snapshots since the last call.
  std::vector<std::string> notices();
  // Warnings about the calibration; the same warning once in ten minutes.
  std::vector<std::string> new_warnings();
  // Readiness of the daemon, over all sites.
  Readiness readiness() const;
  // Logs losses and notes them as a reason against readiness; to be called about every
  // second.
  void log_losses();

 private:
  explicit Process(DaemonSetup setup) : setup_(std::move(setup)) {}
  Expected<void> check_resources(bool estimators_ready) const;
  Expected<void> open_cluster();
  void check_broker();
  Expected<void> open_publishing(PassedSockets& sockets);
  Expected<void> open_http(PassedSockets& sockets);
  ServiceHealth health_of(const RunningSite& site) const;  // current state
  std::vector<ExtraMetric> extra_metrics() const;
  // The sites with a pipeline: also those for which it is a standby.
  std::vector<SiteSet::Site> running_sites() const;
  std::vector<Stage> working_stages() const;
  HttpReply answer_snapshot();

  // A site that is about to run: it has no subscribers yet.
  Expected<RunningSite> begin_site(std::unique_ptr<SiteRuntime> runtime, InputFiles files);
  void end_sites(const std::vector<SiteSet::Site>& sites);
  // The steps that end a site.
  struct Ending {
    SiteSet::Site site;
    std::unique_ptr<Shutdown> steps;
    bool has_failed = false;  // its pipeline may still run: its objects are kept
  };
  // Deadlines of a pipeline: to drain, and to end without its waiting data. Then those of the rest.
  struct Deadlines {
    Shutdown::Time drained;
    Shutdown::Time ended;
    Shutdown::Time closed;
  };
  std::vector<Ending> end_in_parallel(const std::vector<SiteSet::Site>& sites,
                                      const Deadlines& until);
  static std::vector<std::string> stuck_stages(Ending& ending);
  void let_go(const SiteSet::Site& site);
  // Destroys the abandoned sites that have ended meanwhile.
  void release_abandoned();
  void end_for_exchange(const std::vector<SitePreparation::Prepared>& prepared);
  void exchange_sites(std::vector<SitePreparation::Prepared> prepared);
  void listen_to_owner(const std::string& site, std::shared_ptr<SiteOutput> output);
  // For a worker (process_worker.cpp).
  Expected<void> open_claims();
  void keep_ready(SitePreparation::Prepared prepared);
  void tend_claims();
  void own(const ClaimKeeper::Change& change);
  Expected<void> begin_owned(SitePreparation::Prepared prepared, std::uint64_t generation);
  void lose(const SiteSet::Site& site, const std::string& why);
  void show(RunningSite site);
  // For a worker that is a hot standby for sites of others (process_standby.cpp).
  // Adds the sites for which it is a standby to the condition.
  void tend_standby(v1::WorkerState& condition);
  // Adds its load as well; a site that it is too slow for is offered to another worker.
  void tend_load(v1::WorkerState& condition);
  void begin_standby(const std::string& name);
  Expected<SiteSet::Site> computing_along(SitePreparation::Prepared prepared, StandbyStart along);
  Expected<void> promote(const std::string& name, std::uint64_t generation);
  void end_standby(const std::string& name, const std::string& why);
  void note_audit(const RunningSite& site);
  std::vector<ExtraMetric> standby_metrics() const;
  void reload_worker(std::vector<SiteSetup> setups, const std::set<std::string>& changed);
  void end_pipeline(const SiteSet::Site& site);
  enum class AfterReload : std::uint8_t { kAsItWas, kEnded, kAbsent };
  void note_trouble(const std::string& name, const std::string& trouble, AfterReload state);
  std::optional<int> passed_socket(const std::string& name);
  SiteRuntime::Surroundings surroundings(const std::function<void(const std::string&)>& log) const;
  void fill_shared(StatusSources& status) const;
  v1::Heartbeat shared() const;  // counters of the parts that all sites share
  Readiness readiness_of(const RunningSite& site) const;
  void open_api(RunningSite& site) const;
  DaemonApi daemon_api();
  HttpRoutes routes();
  std::string metrics() const;
  std::string sites_json(const std::string& root) const;

  const DaemonSetup setup_;
  const bool has_site_list_ = setup_.config.has_site_list;
  std::shared_ptr<Broker> broker_;        // null: not part of a cluster
  std::string broker_trouble_;            // reason why no server answers; empty: one does
  std::unique_ptr<CaptureRole> capture_;  // null: not a capture node
  std::unique_ptr<ClaimKeeper> claims_;   // null: not a worker
  ProcessLoad load_;
  OverloadRule overload_;
  std::string claim_trouble_;             // last logged
  std::unique_ptr<GatewayRole> gateway_;  // null: not a gateway, as for replicas_
  std::unique_ptr<ReplicaWatch> replicas_;
  // For a worker: sites that it does not own, ready to run, by name, and those to be prepared.
  std::map<std::string, SitePreparation::Prepared> standby_;
  std::vector<SiteSetup> to_prepare_;
  // Sites for which it is a standby, by name; they have no subscribers.
  std::map<std::string, SiteSet::Site> along_;
  using SteadyTime = std::chrono::steady_clock::time_point;
  std::map<std::string, SteadyTime> along_not_before_;  // by site
  SteadyTime along_checked_{};
  StandbyAudits audits_;
  const std::shared_ptr<LimitedLog> limited_log_ = std::make_shared<LimitedLog>(log_event);
  const std::shared_ptr<SharedThreads> shared_threads_ = std::make_shared<SharedThreads>();
  LossWatch shared_losses_{limited_log_};
  const Timestamp started_ = system_now();
  std::uint64_t epoch_ = 0;
  // Progress of threads that count no stage themselves; they outlive these.
  StageProgress guard_progress_;
  StageProgress snapshots_progress_;
  StageProgress http_progress_;
  std::shared_ptr<ConnectionGuard> guard_;
  std::unique_ptr<PublisherStage> publisher_;
  SiteSet sites_;
  std::shared_ptr<PathGridStore> path_grids_;
  std::unique_ptr<SitePreparation> preparation_;       // null: no site is being prepared
  HandedSources handed_;                               // of sites that are being exchanged
  std::map<std::string, v1::ReloadCounters> reloads_;  // by site
  std::vector<Ending> abandoned_;  // have not ended: their objects are kept until they have
  // Of ended sites: each is kept while a channel of its map is still being traced, or a request
  // uses it.
  std::vector<std::shared_ptr<BackgroundText>> ended_channels_;
  std::map<std::string, FileDescriptor> passed_;  // by name; for sites that are started again
  PassedSockets* sockets_ = nullptr;              // during open()
  mutable std::atomic<bool> reload_wanted_{false};
  bool stages_changed_ = false;  // since the last report by tend_sites()
  std::shared_ptr<LastMessages> last_messages_;
  std::unique_ptr<SnapshotServer> snapshots_;
  ProcessHealth health_;
  std::unique_ptr<HttpServer> http_;  // last: its handlers use all the others
  std::vector<std::string> reported_errors_;
  std::vector<std::string> ended_errors_;
};

}  // namespace rayloc
