// The room of the map as an isometric picture, as JSON (daemon/live/http/ROUTES.md,
// "/api/v1/solid").
#pragma once

#include <string>

#include "engine/scene/scene.h"

namespace rayloc {

// An object with more faces than kMaxFacesOfOne, such as a scan,
// is drawn as its bounding box.
std::string map_solid_json(const Scene& scene);

}  // namespace rayloc
