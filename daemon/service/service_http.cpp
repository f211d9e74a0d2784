// The part of Service that answers over HTTP.
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/config/secrets.h"
#include "daemon/live_map/background_text.h"
#include "daemon/live_map/map_channel.h"
#include "daemon/live_map/map_events.h"
#include "daemon/live_map/map_geometry.h"
#include "daemon/log/log.h"
#include "daemon/machine/start_resources.h"
#include "daemon/pipeline/record/system_now.h"
#include "daemon/service/service.h"

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
  HttpApi api;
  api.status = [this] { return status_messages(status_, system_now()); };
  api.health = [this] { return health(); };
  api.metrics = [this] { return extra_metrics(); };
  api.config = [this] {
    const std::lock_guard lock(health_mutex_);
    return config_json_;
  };
  api.snapshot = [this] { return answer_snapshot(); };
  api.playback = recording_clock_.playback;
  api.last = last_messages_;
  api.events = std::make_shared<MapEvents>(message_board_, status_.epoch, system_now);
  if (estimator_) {
    api.map = map_geometry_json(setup_.site, estimator_->room(), !names_->hashed());
    api.calibration = map_calibration_json(setup_.site, estimator_->room());
    const auto channel = std::make_shared<MapChannel>(estimator_->channels());
    const auto text =
        std::make_shared<BackgroundText>([channel] { return channel->json(); }, "[]\n");
    api.channel = [text] { return text->ask(); };
  } else {
    const std::string reason = "nothing is located here ([engine] method is \"none\")";
    api.map = map_without_room_json(setup_.site, reason);
    api.calibration = map_without_calibration_json(reason);
    api.channel = [] { return std::string("[]\n"); };
  }
  Expected<std::unique_ptr<HttpServer>> opened =
      HttpServer::open(options, http_routes(std::move(api)));
  if (!opened) {
    return tl::make_unexpected(opened.error());
  }
  http_ = std::move(*opened);
  status_.http = http_.get();
  return {};
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

ServiceHealth Service::health() const {
  ServiceHealth health;
  health.clock = clock_state();
  health.lacks = lacks_;
  for (const auto& recorder : recorders_) {
    if (std::string error = recorder->counters().files.error; !error.empty()) {
      health.recording_errors.push_back(std::move(error));
    }
  }
  const std::lock_guard lock(health_mutex_);
  health.stuck_stages = stuck_stages_;
  health.saturated = saturation_.reasons();
  health.overloaded = saturation_.warnings();
  health.reload_failed = reload_failed_;
  return health;
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
  const RingSnapshotCounters rings =
      snapshots_of_rings_ ? snapshots_of_rings_->counters() : RingSnapshotCounters{};
  metrics.push_back({"rayloc_recorder_snapshot_files_total",
                     "Files asked for of what was received lately, by what became of them",
                     true,
                     {{"result", "written", static_cast<double>(rings.files)},
                      {"result", "failed", static_cast<double>(rings.failed)}}});
  metrics.push_back({"rayloc_log_dropped_total",
                     "Messages of the log that gave way to newer ones: nobody took them",
                     true,
                     {{"", "", static_cast<double>(log_entries_dropped())}}});
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
