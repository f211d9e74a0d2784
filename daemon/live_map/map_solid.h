// The room of the map as an isometric picture, as JSON (daemon/http/ROUTES.md, "/api/v1/solid").
#pragma once

#include <string>

#include "engine/scene/scene.h"

namespace rayloc {

// An object with more faces than kMostFacesOfOne is drawn as its box: a scanned object is drawn as
// the thing it represents.
std::string map_solid_json(const Scene& scene);

}  // namespace rayloc
