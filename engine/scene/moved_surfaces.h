// move_surfaces: a scene whose faces are moved along their normals, as calibration finds them.
//
// A vertex belongs to all faces whose planes it lies on, and is moved by the smallest
// displacement onto all of the moved planes: corners of boxes stay corners. A mesh's other
// vertices are unchanged.
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc {

// `offset` [m] of each of scene.surfaces(), along Surface::plane().normal. An Error when the result
// is no valid scene (Scene::create).
Expected<Scene> move_surfaces(const Scene& scene, std::span<const double> offset);

}  // namespace rayloc
