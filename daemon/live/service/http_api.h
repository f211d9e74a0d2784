// The HTTP paths of raylocd and their responses.
//
// Paths of the daemon:
//   /healthz              200 while every stage makes progress, otherwise 503 with their names
//   /readyz               200 or 503, with reasons (readiness.h)
//   /metrics              Prometheus text
//   /api/v1/config        every key in effect, by section
//   /api/v1/sites         an array: name, path, ready, reasons, warnings, counts of each site
//   /  /map/NAME          the live map (http/map_files.h); with [[site]] the list of sites
//   POST /api/v1/record/snapshot   202 and the files that the recent datagrams are written to
//
// Paths of a site, below /site/NAME, and for the only one ([site]) at the top as well; with
// [[site]] those of /api/v1 answer at the top with ?site=NAME, and 404 with the names otherwise:
//   /api/v1/status        a v1::Heartbeat as JSON
//   /api/v1/sources       an array of v1::SourceState
//   /api/v1/targets       an array of the last v1::Envelope of each target
//   /api/v1/map           the static content of the map (map_geometry.h)
//   /api/v1/solid         the same room as an isometric picture (map_solid.h)
//   /api/v1/calibration   content of the report beside the calibration (map_geometry.h)
//   /api/v1/presence      positions occupied in the last hours (map_presence.h)
//   /api/v1/channel       channels of located devices, measured and simulated (map_channel.h)
//   /api/v1/playback      a v1::Playback; POST changes it (playback_control.h); recordings only
//   /readyz               of this site
//   /events               server-sent events: the published messages (map_events.h)
//   /  /map/NAME          its live map
//   /edit  /api/v1/edit  /api/v1/survey  /api/v1/calibrate   its editor (studio_routes.h), with
//   [http] edit
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "daemon/live/health/readiness.h"
#include "daemon/live/http/http_server.h"
#include "daemon/live/studio/calibration_job.h"
#include "daemon/live/studio/site_editor.h"
#include "daemon/live/studio/walked_survey.h"
#include "daemon/messages/last_messages.h"
#include "daemon/pipeline/playback/playback.h"

namespace rayloc {

class PdfPage;

// Data sources for the responses of a site; called on the server's thread.
struct SiteApi {
  std::string component;  // of its topics and paths
  std::function<StatusMessages()> status;
  std::function<Readiness()> readiness;
  std::shared_ptr<Playback> playback;  // null: this path does not exist
  std::shared_ptr<const LastMessages> last;
  std::shared_ptr<EventFeed> events;
  std::string map;                        // JSON
  std::string solid;                      // JSON
  std::string calibration;                // JSON
  std::function<std::string()> channel;   // JSON
  std::function<std::string()> presence;  // JSON
  // Null: the site cannot be edited.
  std::shared_ptr<const SiteEditor> editor;
  std::shared_ptr<WalkedSurvey> survey;
  std::shared_ptr<CalibrationJob> calibration_job;  // of that survey
  std::shared_ptr<PdfPage> plan;                    // under the drawing
};

// The same for the daemon.
struct DaemonApi {
  std::function<std::vector<std::string>()> stuck_stages;
  std::function<Readiness()> readiness;
  std::function<std::string()> metrics;
  std::function<std::string()> config;  // JSON
  std::function<HttpReply()> snapshot;
  // JSON; `root`: relative path from the request to the top, "" or "../../".
  std::function<std::string(const std::string& root)> sites;
};

using HttpRoutes = std::map<std::string, HttpRoute>;

// Routes of the only site, at the top.
HttpRoutes single_site_routes(const DaemonApi& daemon, const std::shared_ptr<const SiteApi>& site);
// Each site below its own path. `absent`: sites that do not run, by name, with their response.
HttpRoutes site_list_routes(const DaemonApi& daemon,
                            const std::vector<std::shared_ptr<const SiteApi>>& sites,
                            const std::map<std::string, std::string>& absent);

// Reason why a site that has never started is not ready.
std::string absence(const std::string& why);

}  // namespace rayloc
