// The closed objects of a scene that things cannot be in: furniture, inner walls.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

class Scene;

// Without those that are around a point of `inside`: they are the hull of the room. The scene must
// live as long.
std::vector<const Mesh*> closed_objects(const Scene& scene, const std::vector<Vec3d>& inside);

}  // namespace rayloc
