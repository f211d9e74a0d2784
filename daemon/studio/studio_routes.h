// The paths of the editor:
//
//   /edit                  its page
//   /api/v1/edit           what it draws (site_editor.h); POST: a draft, which is written
//   /api/v1/survey         the survey that is walked; POST ?do=stand&x=1&y=2&z=1.2, keep, leave
//   /api/v1/calibrate      how far its calibration is; POST ?do=start&what=all, stop
//   /calibration-report    the report of the last one, a page
//
// and where a folder may be empty (rayloc studio):
//
//   POST /api/v1/edit/room     a plan as `rayloc scene room` reads it
//   POST /api/v1/edit/import   ?name=scan.glb, with the file as the body
//
// All that changes something needs what the controls of the map need (http_server.h), and a body
// of its own type, which no form of another page can send.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "daemon/http/http_server.h"
#include "daemon/studio/calibration_job.h"
#include "daemon/studio/site_editor.h"
#include "daemon/studio/walked_survey.h"

namespace rayloc {

// `survey` may be null: nobody is heard.
std::map<std::string, HttpRoute> editor_routes(const std::shared_ptr<const SiteEditor>& editor,
                                               const std::shared_ptr<WalkedSurvey>& survey);

// `job` may be null: nothing is recorded here.
std::map<std::string, HttpRoute> calibration_routes(const std::shared_ptr<CalibrationJob>& job);

// For a folder that has no site yet.
std::map<std::string, HttpRoute> beginning_routes(const std::shared_ptr<const SiteEditor>& editor);

// Answers of both kinds.
HttpReply editor_reply(const Expected<nlohmann::ordered_json>& result);

}  // namespace rayloc
