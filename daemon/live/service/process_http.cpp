// The part of Process that handles HTTP.
#include <algorithm>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/live/config/secrets.h"
#include "daemon/live/machine/start_resources.h"
#include "daemon/live/service/process.h"
#include "daemon/live/service/process_metrics.h"
#include "daemon/live/service/site/site_api.h"
#include "daemon/messages/topic.h"
#include "daemon/pipeline/record/system_now.h"

namespace rayloc {

Expected<void> Process::open_http(PassedSockets& sockets) {
  const HttpConfig& config = setup_.config.http;
  if (!config.enabled) {
    return {};
  }
  const Expected<std::string> token =
      config.token_file.empty() ? std::string() : read_http_token(config.token_file);
  RAYLOC_TRY(token);
  HttpServer::Options options;
  options.limits.connections = affordable_connections(options.limits.connections);
  options.host = config.host;
  options.port = config.port;
  options.adopted_fd = sockets.take("http").value_or(-1);
  options.token = *token;
  options.front = config.front;
  options.on_round = [this] { http_progress_.beat(); };
  Expected<std::unique_ptr<HttpServer>> opened = HttpServer::open(options, routes());
  RAYLOC_TRY(opened);
  http_ = std::move(*opened);
  for (const SiteSet::Site& site : sites_.all()) {
    fill_shared(site->runtime->status_sources());
  }
  return {};
}

HttpRoutes Process::routes() {
  std::vector<std::shared_ptr<const SiteApi>> apis;
  for (const SiteSet::Site& site : sites_.all()) {
    apis.push_back(site->api);
  }
  return has_site_list_ ? site_list_routes(daemon_api(), apis, sites_.absent())
                        : single_site_routes(daemon_api(), apis.front());
}

void Process::open_api(RunningSite& site) const {
  if (!setup_.config.http.enabled) {
    return;
  }
  SiteApiOptions options;
  options.last = last_messages_;
  options.epoch = epoch_;
  options.readiness = [this, name = site.name()] {
    const SiteSet::Site now = sites_.find(name);
    return now ? readiness_of(*now) : Readiness{{"it has ended"}, {}};
  };
  if (setup_.config.http.edit) {
    options.on_saved = [this] {
      if (!has_site_list_) {
        return std::string("saved; raylocd takes it up when it is started again");
      }
      reload_wanted_ = true;
      return std::string("saved; raylocd takes it up now");
    };
  }
  options.before = sites_.find(site.name());
  open_site_api(site, std::move(options));
}

DaemonApi Process::daemon_api() {
  DaemonApi api;
  api.stuck_stages = [this] { return health_.stuck_stages(); };
  api.readiness = [this] { return readiness(); };
  api.metrics = [this] { return metrics(); };
  api.config = [this] { return health_.config_json(); };
  api.snapshot = [this] { return answer_snapshot(); };
  api.sites = [this](const std::string& root) { return sites_json(root); };
  return api;
}

std::string Process::metrics() const {
  std::vector<SiteHeartbeat> heartbeats;
  for (const SiteSet::Site& site : sites_.all()) {
    heartbeats.push_back(
        {has_site_list_ ? site->name() : "", site->runtime->status(system_now()).heartbeat});
  }
  return metrics_text(heartbeats, shared().publisher(), extra_metrics());
}

std::string Process::sites_json(const std::string& root) const {
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

Readiness Process::readiness_of(const RunningSite& site) const {
  Readiness now = rayloc::readiness(site.runtime->status(system_now()), health_of(site));
  if (site.has_ended) {
    now.reasons.push_back("it has ended, and the last reload could not begin it: " + site.trouble);
  } else if (!site.trouble.empty()) {
    now.warnings.push_back("the last reload left it as it was: " + site.trouble);
  }
  return now;
}

// With several sites each reason names its site; reasons of the daemon are stated once.
Readiness Process::readiness() const {
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

HttpReply Process::answer_snapshot() {
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

std::string Process::http_address() const {
  return http_ ? setup_.config.http.host + ":" + std::to_string(http_->port()) : "";
}

void Process::note_reload(bool successful, const ConfigValues* values) {
  health_.note_reload(successful, values, system_now());
}

void Process::note_stuck(std::vector<std::string> stages) { health_.note_stuck(std::move(stages)); }

ServiceHealth Process::health_of(const RunningSite& site) const {
  ServiceHealth health = site.runtime->health();
  health.clock = clock_state();
  health_.fill(health, has_site_list_ ? site.label() : "");
  return health;
}

std::vector<ExtraMetric> Process::extra_metrics() const {
  std::vector<ExtraMetric> metrics = http_metrics(http_->counters());
  const auto add = [&metrics](const std::vector<ExtraMetric>& some) {
    metrics.insert(metrics.end(), some.begin(), some.end());
  };
  metrics.push_back(snapshot_metric(snapshots_->counters()));
  metrics.push_back(ring_metric(sites_));
  metrics.push_back(log_metric());
  if (has_site_list_) {
    metrics.push_back(running_sites_metric(sites_));
  }
  if (broker_) {
    add(cluster_metrics(*broker_, claims_.get(), replicas_.get(), sites_));
  }
  add(standby_metrics());
  if (capture_) {
    metrics.push_back(history_metric(sites_));
  }
  add(health_.metrics());
  return metrics;
}

}  // namespace rayloc
