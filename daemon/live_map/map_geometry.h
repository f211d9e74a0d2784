// What the map draws that does not move, as JSON (the keys: daemon/http/ROUTES.md, "/api/v1/map").
#pragma once

#include <string>
#include <vector>

#include "daemon/site/site.h"
#include "engine/room/room_model.h"
#include "engine/scene/scene.h"

namespace rayloc {

// `room`: with its scene. `methods`: by name, the site's own before those that are compared with
// it. `addresses`: of fixed transmitters, else empty.
std::string map_geometry_json(const Site& site,
                              const RoomModel& room,
                              const std::vector<std::string>& methods,
                              bool addresses = true);

// The "plan" of it alone: what the scene looks like from above.
std::string map_plan_json(const Scene& scene);

// Of a site where nothing is located: {"site": ..., "available": false, "reason": ...}.
std::string map_without_room_json(const Site& site, const std::string& reason);

// What the report beside the calibration in use says of it: what moved, and how well each surveyed
// point fits. {"available": false, "reason": ...} where there is none that belongs to it.
std::string map_calibration_json(const Site& site, const RoomModel& room);
std::string map_without_calibration_json(const std::string& reason);

}  // namespace rayloc
