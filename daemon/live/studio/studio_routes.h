// The paths of the editor:
//
//   /edit                  the page of the editor
//   /api/v1/edit           its data (site_editor.h); POST: writes a draft
//   POST /api/v1/edit/pdf      ?page=1, with a PDF as the body: begins to convert it (pdf_page.h)
//   POST /api/v1/edit/page     ?number=N: whether that conversion runs, or the size of its page
//   POST /api/v1/edit/picture  ?number=N: its picture, once
//   /api/v1/survey         the walked survey; `POST ?do=stand&x=1&y=2&z=1.2`, keep, leave
//   /api/v1/calibrate      progress of the calibration; POST ?do=start&what=all, stop
//   /calibration-report    page with the last report
//
// and for folders that may be empty (rayloc studio):
//
//   POST /api/v1/edit/room     a plan for `rayloc scene room`
//   POST /api/v1/edit/import   ?name=scan.glb, with the file as the body; unit, scale, height and
//                              walls (repeated for several layers) as for `rayloc scene import`
//
// Every changing request needs what the controls of the map need (http_server.h), and a body of its
// own type, which no form of another page can send.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "daemon/live/http/http_server.h"
#include "daemon/live/studio/calibration_job.h"
#include "daemon/live/studio/site_editor.h"
#include "daemon/live/studio/walked_survey.h"

namespace rayloc {

class PdfPage;

// `survey` may be null: no frames are received. `plan` outlives the routes, so that a change of the
// routes does not end its conversion.
std::map<std::string, HttpRoute> editor_routes(const std::shared_ptr<const SiteEditor>& editor,
                                               const std::shared_ptr<WalkedSurvey>& survey,
                                               const std::shared_ptr<PdfPage>& plan);

// `job` may be null: nothing is recorded here.
std::map<std::string, HttpRoute> calibration_routes(const std::shared_ptr<CalibrationJob>& job);

// For a folder without a site. An import ends early when `is_stopping`, which the threads of the
// server call, returns true.
std::map<std::string, HttpRoute> beginning_routes(const std::shared_ptr<const SiteEditor>& editor,
                                                  const std::function<bool()>& is_stopping);

// Replies for results and errors.
HttpReply editor_reply(const Expected<nlohmann::ordered_json>& result);

}  // namespace rayloc
