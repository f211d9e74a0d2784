// The part of Service that handles HTTP.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/live/config/secrets.h"
#include "daemon/live/live_map/background_text.h"
#include "daemon/live/live_map/map_channel.h"
#include "daemon/live/live_map/map_events.h"
#include "daemon/live/live_map/map_geometry.h"
#include "daemon/live/live_map/map_presence.h"
#include "daemon/live/live_map/map_solid.h"
#include "daemon/live/log/log.h"
#include "daemon/live/machine/start_resources.h"
#include "daemon/live/service/service.h"
#include "daemon/messages/topic.h"
#include "daemon/pipeline/record/recording_folder.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {
namespace {

std::vector<ExtraMetric> http_metrics(const HttpCounters& http) {
  std::vector<ExtraMetric> metrics;
  ExtraMetric requests{"rayloc_http_requests_total", "Answers over HTTP by status", true, {}};
  for (const auto& [status, count] : http.requests) {
    requests.samples.push_back({"status", std::to_string(status), static_cast<double>(count)});
  }
  metrics.push_back(std::move(requests));
  metrics.push_back({"rayloc_http_closed_total",
                     "HTTP connections closed by us before their answer was fetched",
                     true,
                     {{"reason", "slow", static_cast<double>(http.timed_out)},
                      {"reason", "displaced", static_cast<double>(http.displaced)}}});
  metrics.push_back({"rayloc_http_viewers",
                     "Open streams of events",
                     false,
                     {{"", "", static_cast<double>(http.viewers)}}});
  metrics.push_back({"rayloc_http_viewers_ended_total",
                     "Streams of events that ended or were refused",
                     true,
                     {{"reason", "left", static_cast<double>(http.viewers_left)},
                      {"reason", "stuck", static_cast<double>(http.viewers_stuck)},
                      {"reason", "refused", static_cast<double>(http.viewers_refused)}}});
  metrics.push_back({"rayloc_http_events_total",
                     "Events given to viewers, all together",
                     true,
                     {{"", "", static_cast<double>(http.events)}}});
  metrics.push_back({"rayloc_http_messages_coalesced_total",
                     "Messages that newer ones replaced before a viewer was asked, all together",
                     true,
                     {{"", "", static_cast<double>(http.messages_coalesced)}}});
  return metrics;
}

std::uint64_t sum_of(const NumberedRing::Counts& counts) {
  std::uint64_t all = 0;
  for (const auto& [access_point, count] : counts) {
    all += count;
  }
  return all;
}

// For a capture node: state of the datagrams that are missing according to marks of gaps.
ExtraMetric history_metric(const SiteSet& sites) {
  std::uint64_t marked = 0;
  std::uint64_t filled = 0;
  std::uint64_t waiting = 0;
  for (const SiteSet::Site& site : sites.all()) {
    if (const BatchSender* const sender = site->runtime->sender(); sender != nullptr) {
      const BatchSender::Counters counters = sender->counters();
      marked += sum_of(counters.ring.marked);
      filled += sum_of(counters.filled);
      waiting += sum_of(counters.to_fill);
    }
  }
  return {"rayloc_cluster_history_datagrams",
          "Datagrams in marks of gaps by where they are",
          false,
          {{"state", "filled_in", static_cast<double>(filled)},
           {"state", "waiting", static_cast<double>(waiting)},
           {"state", "recordings_alone", static_cast<double>(marked - filled - waiting)}}};
}

// For a machine of a cluster. `sites`: of a worker, the numbers of owned and of other sites.
std::vector<ExtraMetric> cluster_metrics(const Broker& broker,
                                         const ClaimKeeper* claims,
                                         std::pair<std::size_t, std::size_t> sites) {
  std::vector<ExtraMetric> metrics = {{"rayloc_cluster_broker_connected",
                                       "1 where a server of the cluster answers",
                                       false,
                                       {{"", "", broker.connected() ? 1.0 : 0.0}}},
                                      {"rayloc_cluster_broker_connections_total",
                                       "How often this machine has connected to a server",
                                       true,
                                       {{"", "", static_cast<double>(broker.connections())}}},
                                      {"rayloc_cluster_broker_failed_tries_total",
                                       "Tries to make a connection that failed",
                                       true,
                                       {{"", "", static_cast<double>(broker.failed_tries())}}}};
  if (claims != nullptr) {
    metrics.push_back({"rayloc_cluster_worker_sites",
                       "Sites of this worker by whether it works for them",
                       false,
                       {{"state", "owned", static_cast<double>(sites.first)},
                        {"state", "waiting", static_cast<double>(sites.second)}}});
    metrics.push_back({"rayloc_cluster_worker_leaving",
                       "1 while it gives its sites back and takes no more",
                       false,
                       {{"", "", claims->is_leaving() ? 1.0 : 0.0}}});
  }
  return metrics;
}

// The method of the site, and those that are compared with it.
std::vector<std::string> names_of_methods(const EngineConfig& engine) {
  std::vector<std::string> names{std::string(engine.method->name)};
  for (const Method* method : engine.compared) {
    names.emplace_back(method->name);
  }
  return names;
}

// AP=FILE for the recordings of its sources since then, as `rayloc calibrate --capture` takes it.
Expected<std::vector<std::string>> recorded_captures(const DaemonConfig& config, Timestamp since) {
  if (config.record.directory.empty()) {
    return bad_input(
        "nothing is recorded, so a survey cannot be calibrated: set directory in [record] of " +
        config.file.string() + ", start raylocd again, and walk the survey then");
  }
  std::vector<std::string> captures;
  for (const SourceConfig& source : config.sources) {
    for (const std::filesystem::path& file :
         recordings_since(config.record.directory, source.access_point, since)) {
      captures.push_back(source.access_point + "=" + file.string());
    }
  }
  if (captures.empty()) {
    return bad_input(config.record.directory.string() +
                     ": no recording of the time of the survey is left; walk it again");
  }
  return captures;
}

}  // namespace

Expected<void> Service::open_http(PassedSockets& sockets) {
  const HttpConfig& config = setup_.config.http;
  if (!config.enabled) {
    return {};
  }
  const Expected<std::string> token =
      config.token_file.empty() ? std::string() : read_http_token(config.token_file);
  if (!token) {
    return tl::make_unexpected(token.error());
  }
  HttpServer::Options options;
  options.limits.connections = affordable_connections(options.limits.connections);
  options.host = config.host;
  options.port = config.port;
  options.adopted_fd = sockets.take("http").value_or(-1);
  options.token = *token;
  options.front = config.front;
  options.on_round = [this] { http_progress_.beat(); };
  Expected<std::unique_ptr<HttpServer>> opened = HttpServer::open(options, routes());
  if (!opened) {
    return tl::make_unexpected(opened.error());
  }
  http_ = std::move(*opened);
  for (const SiteSet::Site& site : sites_.all()) {
    fill_shared(site->runtime->status_sources());
  }
  return {};
}

HttpRoutes Service::routes() {
  std::vector<std::shared_ptr<const SiteApi>> apis;
  for (const SiteSet::Site& site : sites_.all()) {
    apis.push_back(site->api);
  }
  return has_site_list_ ? site_list_routes(daemon_api(), apis, sites_.absent())
                        : single_site_routes(daemon_api(), apis.front());
}

// Handlers hold the objects that they read from, for as long as requests may use them.
void Service::open_api(RunningSite& running) const {
  if (!setup_.config.http.enabled) {
    return;
  }
  SiteRuntime& runtime = *running.runtime;
  SiteApi api;
  api.component = topic_component(running.name());
  api.status = [runtime = running.runtime, output = running.output] {
    return runtime->status(system_now());
  };
  api.readiness = [this, name = running.name()] {
    const SiteSet::Site now = sites_.find(name);
    return now ? readiness_of(*now) : Readiness{{"it has ended"}, {}};
  };
  api.playback = runtime.playback();
  api.last = last_messages_;
  api.events = std::make_shared<MapEvents>(running.board, epoch_, system_now);
  api.presence = [board = running.board] { return map_presence_json(*board, system_now()); };
  const Site& site = runtime.setup().site;
  api.channel = [] { return std::string("[]\n"); };
  if (const RoomModel* const room = runtime.room(); room != nullptr) {
    const EngineConfig& engine = runtime.setup().config.engine;
    api.map = map_geometry_json(site, *room, names_of_methods(engine), !runtime.names_hashed());
    api.solid = map_solid_json(*room->scene);
    api.calibration = map_calibration_json(site, *room);
  } else {
    const std::string reason = "nothing is located here ([engine] method is \"none\")";
    api.map = map_without_room_json(site, reason);
    api.solid = map_without_room_json(site, reason);
    api.calibration = map_without_calibration_json(reason);
  }
  if (DeviceEstimator* const estimator = runtime.estimator(); estimator != nullptr) {
    const auto channel = std::make_shared<MapChannel>(estimator->channels());
    running.channel = std::make_shared<BackgroundText>(
        [keep = running.runtime, channel] { return channel->json(); }, "[]\n");
    api.channel = [text = running.channel] { return text->ask(); };
  }
  if (setup_.config.http.edit) {
    offer_editor(running, api);
  }
  running.api = std::make_shared<const SiteApi>(std::move(api));
}

void Service::offer_editor(const RunningSite& running, SiteApi& api) const {
  const std::filesystem::path& folder = running.runtime->setup().site.directory;
  api.editor = std::make_shared<const SiteEditor>(folder, [this] {
    if (!has_site_list_) {
      return std::string("saved; raylocd takes it up when it is started again");
    }
    reload_wanted_ = true;
    return std::string("saved; raylocd takes it up now");
  });
  api.survey = std::make_shared<WalkedSurvey>(folder / "survey.csv", [runtime = running.runtime] {
    WalkedSurvey::Frames frames;
    const StatusMessages status = runtime->status(system_now());
    for (const v1::SourceReport& source : status.heartbeat.sources()) {
      frames[source.access_point()] += source.counters().frames_complete();
    }
    return frames;
  });
  const SiteSet::Site before = sites_.find(running.name());
  if (before && before->api && before->api->calibration_job &&
      before->runtime->setup().site.directory == folder) {
    api.calibration_job = before->api->calibration_job;  // it may run, and outlives a reload
    return;
  }
  api.calibration_job = std::make_shared<CalibrationJob>(
      folder, [config = running.runtime->setup().config](Timestamp since) {
        return recorded_captures(config, since);
      });
}

DaemonApi Service::daemon_api() {
  DaemonApi api;
  api.stuck_stages = [this] {
    const std::lock_guard lock(health_mutex_);
    return stuck_stages_;
  };
  api.readiness = [this] { return readiness(); };
  api.metrics = [this] { return metrics(); };
  api.config = [this] {
    const std::lock_guard lock(health_mutex_);
    return config_json_;
  };
  api.snapshot = [this] { return answer_snapshot(); };
  api.sites = [this](const std::string& root) { return sites_json(root); };
  return api;
}

std::string Service::metrics() const {
  std::vector<SiteHeartbeat> heartbeats;
  for (const SiteSet::Site& site : sites_.all()) {
    heartbeats.push_back(
        {has_site_list_ ? site->name() : "", site->runtime->status(system_now()).heartbeat});
  }
  return metrics_text(heartbeats, shared().publisher(), extra_metrics());
}

std::string Service::sites_json(const std::string& root) const {
  auto list = nlohmann::ordered_json::array();
  for (const SiteSet::Site& site : sites_.all()) {
    const Readiness now = readiness_of(*site);
    const v1::Heartbeat heartbeat = site->runtime->status(system_now()).heartbeat;
    const auto receiving = std::count_if(
        heartbeat.sources().begin(), heartbeat.sources().end(), [](const v1::SourceReport& one) {
          return one.status() == v1::SOURCE_STATUS_RECEIVING;
        });
    list.push_back({{"name", site->name()},
                    {"path", root + "site/" + topic_component(site->name()) + "/"},
                    {"listed", has_site_list_},
                    {"running", !site->has_ended},
                    {"editable", site->api != nullptr && site->api->editor != nullptr},
                    {"ready", now.ready()},
                    {"reasons", now.reasons},
                    {"warnings", now.warnings},
                    {"located", site->runtime->room() != nullptr},
                    {"sources", heartbeat.sources_size()},
                    {"sources_receiving", receiving},
                    {"fixes", heartbeat.estimation().fixes()},
                    {"tracks", heartbeat.tracker().tracks()}});
  }
  for (const auto& [name, why] : sites_.absent()) {
    list.push_back({{"name", name},
                    {"path", root + "site/" + topic_component(name) + "/"},
                    {"listed", true},
                    {"running", false},
                    {"editable", false},
                    {"ready", false},
                    {"reasons", {absence(why)}},
                    {"warnings", nlohmann::json::array()},
                    {"located", false},
                    {"sources", 0},
                    {"sources_receiving", 0},
                    {"fixes", 0},
                    {"tracks", 0}});
  }
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Readiness Service::readiness_of(const RunningSite& site) const {
  Readiness now = rayloc::readiness(site.runtime->status(system_now()), health_of(site));
  if (site.has_ended) {
    now.reasons.push_back("it has ended, and the last reload could not begin it: " + site.trouble);
  } else if (!site.trouble.empty()) {
    now.warnings.push_back("the last reload left it as it was: " + site.trouble);
  }
  return now;
}

// With several sites each reason names its site; reasons of the daemon are stated once.
Readiness Service::readiness() const {
  const std::vector<SiteSet::Site> sites = sites_.all();
  if (!has_site_list_) {
    return readiness_of(*sites.front());
  }
  Readiness all;
  all.clock = clock_state();
  const auto add = [](const std::string& label,
                      const std::vector<std::string>& some,
                      std::vector<std::string>& to) {
    for (const std::string& one : some) {
      const bool of_daemon = one.rfind("stage ", 0) == 0 || one.rfind("the clock ", 0) == 0 ||
                             one.rfind("the last reload failed", 0) == 0;
      std::string line = of_daemon ? one : label + one;
      if (std::find(to.begin(), to.end(), line) == to.end()) {
        to.push_back(std::move(line));
      }
    }
  };
  for (const SiteSet::Site& site : sites) {
    const Readiness one = readiness_of(*site);
    add(site->label(), one.reasons, all.reasons);
    add(site->label(), one.warnings, all.warnings);
  }
  // For a worker they are those of others.
  for (const auto& [name, why] : claims_ ? SiteSet::Absent{} : sites_.absent()) {
    all.reasons.push_back("site '" + name + "': " + absence(why));
  }
  return all;
}

HttpReply Service::answer_snapshot() {
  constexpr int kAccepted = 202;
  constexpr int kUnavailable = 503;
  const Expected<std::vector<std::string>> files = snapshot();
  const nlohmann::ordered_json json =
      files ? nlohmann::ordered_json{{"files", *files}}
            : nlohmann::ordered_json{{"error", files.error().message}};
  return {files ? kAccepted : kUnavailable,
          "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

std::string Service::http_address() const {
  return http_ ? setup_.config.http.host + ":" + std::to_string(http_->port()) : "";
}

void Service::note_reload(bool successful, const ConfigValues* values) {
  const std::lock_guard lock(health_mutex_);
  reload_failed_ = !successful;
  reloaded_ = system_now();
  if (values != nullptr) {
    config_json_ = values->json();
  }
}

void Service::note_stuck(std::vector<std::string> stages) {
  const std::lock_guard lock(health_mutex_);
  stuck_stages_ = std::move(stages);
}

ServiceHealth Service::health_of(const RunningSite& site) const {
  ServiceHealth health = site.runtime->health();
  health.clock = clock_state();
  const std::lock_guard lock(health_mutex_);
  for (const std::string& stage : stuck_stages_) {  // stages of other sites are left out
    if (!has_site_list_ || stage.rfind("site '", 0) != 0 || stage.rfind(site.label(), 0) == 0) {
      health.stuck_stages.push_back(stage);
    }
  }
  health.reload_failed = reload_failed_;
  return health;
}

ExtraMetric Service::running_sites() const {
  ExtraMetric metric{"rayloc_site_running",
                     "0 for a site of the configuration that has ended or never begun",
                     false,
                     {}};
  for (const SiteSet::Site& site : sites_.all()) {
    metric.samples.push_back({"site", site->name(), site->has_ended ? 0.0 : 1.0});
  }
  for (const auto& [name, why] : sites_.absent()) {
    metric.samples.push_back({"site", name, 0.0});
  }
  return metric;
}

std::vector<ExtraMetric> Service::extra_metrics() const {
  std::vector<ExtraMetric> metrics = http_metrics(http_->counters());
  const SnapshotCounters snapshots = snapshots_->counters();
  metrics.push_back({"rayloc_snapshot_requests_total",
                     "Requests of late subscribers by what became of them",
                     true,
                     {{"result", "answered", static_cast<double>(snapshots.answered)},
                      {"result", "malformed", static_cast<double>(snapshots.malformed)},
                      {"result", "dropped", static_cast<double>(snapshots.dropped)}}});
  RingSnapshotCounters rings;
  for (const SiteSet::Site& site : sites_.all()) {
    if (const RingSnapshots* const some = site->runtime->ring_snapshots(); some != nullptr) {
      rings.files += some->counters().files;
      rings.failed += some->counters().failed;
    }
  }
  metrics.push_back({"rayloc_recorder_snapshot_files_total",
                     "Requested files of recent datagrams, by result",
                     true,
                     {{"result", "written", static_cast<double>(rings.files)},
                      {"result", "failed", static_cast<double>(rings.failed)}}});
  metrics.push_back({"rayloc_log_dropped_total",
                     "Messages of the log that newer ones displaced before a client read them",
                     true,
                     {{"", "", static_cast<double>(log_entries_dropped())}}});
  if (has_site_list_) {
    metrics.push_back(running_sites());
  }
  if (broker_) {
    for (ExtraMetric& metric :
         cluster_metrics(*broker_, claims_.get(), {sites_.all().size(), sites_.absent().size()})) {
      metrics.push_back(std::move(metric));
    }
  }
  for (ExtraMetric& metric : standby_metrics()) {
    metrics.push_back(std::move(metric));
  }
  if (capture_) {
    metrics.push_back(history_metric(sites_));
  }
  const std::lock_guard lock(health_mutex_);
  metrics.push_back({"rayloc_config_last_reload_successful",
                     "0 when the last reload found the configuration wrong",
                     false,
                     {{"", "", reload_failed_ ? 0.0 : 1.0}}});
  metrics.push_back({"rayloc_config_last_reload_timestamp_seconds",
                     "When the configuration was last read, in seconds since 1970",
                     false,
                     {{"", "", to_seconds(reloaded_.time_since_epoch())}}});
  metrics.push_back({"rayloc_stages_stuck",
                     "Threads that make no progress",
                     false,
                     {{"", "", static_cast<double>(stuck_stages_.size())}}});
  return metrics;
}

}  // namespace rayloc
