// The triangles of each surface of a scene, from which a Surface (convex pieces, outline) is made.
#pragma once

#include <array>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

using Triangle = std::array<Vec3d, 3>;

// One entry per surface, in their order; every triangle of the scene is in one of them.
std::vector<std::vector<Triangle>> surface_triangles(const Scene& scene);

}  // namespace rayloc
