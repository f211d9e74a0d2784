// The static part of the map, as JSON (the keys: daemon/live/http/ROUTES.md, "/api/v1/map").
#pragma once

#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/room/room_model.h"
#include "engine/scene/scene.h"

namespace rayloc {

// `room`: with its scene. `methods`: by name, the site's own before the compared ones. `addresses`:
// of fixed transmitters, otherwise empty.
std::string map_geometry_json(const Site& site,
                              const RoomModel& room,
                              const std::vector<std::string>& methods,
                              bool addresses = true);

// Only its "plan": the scene as seen from above.
std::string map_plan_json(const Scene& scene);

// For a site without localization: {"site": ..., "available": false, "reason": ...}.
std::string map_without_room_json(const Site& site, const std::string& reason);

// The content of the report beside the calibration in use: the moved antennas and the fit of each
// surveyed point. {"available": false, "reason": ...} if no report belongs to it.
std::string map_calibration_json(const Site& site, const RoomModel& room);
std::string map_without_calibration_json(const std::string& reason);

}  // namespace rayloc
