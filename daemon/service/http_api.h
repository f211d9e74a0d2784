// The paths that raylocd answers over HTTP, and what with.
//
//   /healthz              200 while every stage makes progress, else 503 with their names
//   /readyz               200 or 503, with reasons (readiness.h)
//   /metrics              Prometheus text
//   /api/v1/status        a v1::Heartbeat as JSON
//   /api/v1/sources       an array of v1::SourceState
//   /api/v1/targets       an array of the last v1::Envelope of each target
//   /api/v1/config        every key that holds, by section
//   /api/v1/map           what the map draws that does not move (map_geometry.h)
//   /api/v1/calibration   what the report beside the calibration says (map_geometry.h)
//   /api/v1/channel       channels of located devices, measured and simulated (map_channel.h)
//   /api/v1/playback      a v1::Playback; POST changes it (playback_control.h); recordings only
//   /events               server-sent events: what is published (map_events.h)
//   /  /map/NAME          the live map (daemon/http/map_files.h)
//   POST /api/v1/record/snapshot   202 and the files that what came lately is being written to
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/health/readiness.h"
#include "daemon/http/http_server.h"
#include "daemon/http/metrics.h"
#include "daemon/pipeline/playback/playback.h"
#include "daemon/publish/last_messages.h"

namespace rayloc {

// Where the answers come from; called on the server's thread, and outlives it.
struct HttpApi {
  std::function<StatusMessages()> status;
  std::function<ServiceHealth()> health;
  std::function<std::vector<ExtraMetric>()> metrics;
  std::function<std::string()> config;  // JSON
  std::function<HttpReply()> snapshot;
  std::shared_ptr<Playback> playback;  // null: this path does not exist
  std::shared_ptr<const LastMessages> last;
  std::shared_ptr<EventFeed> events;
  std::string map;                       // JSON
  std::string calibration;               // JSON
  std::function<std::string()> channel;  // JSON
};

std::map<std::string, HttpRoute> http_routes(HttpApi api);

}  // namespace rayloc
