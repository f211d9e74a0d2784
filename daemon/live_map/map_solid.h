// The room of the map as an isometric picture, as JSON (daemon/http/ROUTES.md, "/api/v1/solid").
#pragma once

#include <string>

#include "engine/scene/scene.h"

namespace rayloc {

// Of an object with more faces than kMostFacesOfOne its box is drawn: a scan is drawn as what it is
// of.
std::string map_solid_json(const Scene& scene);

}  // namespace rayloc
