// The report of a scene as text: a table for people, JSON for scripts (`rayloc scene check`).
#pragma once

#include <string>

#include "daemon/site/scene/scene_report.h"
#include "daemon/site/scene/scene_source.h"

namespace rayloc {

// Names are those of the scene file and may contain control characters. Lengths in metres.
std::string scene_report_text(const SceneSource& source, const SceneReport& report);

// One JSON object and a newline; invalid UTF-8 in names is replaced.
std::string scene_report_json(const SceneSource& source, const SceneReport& report);

}  // namespace rayloc
