// The closed objects of a scene that exclude other objects: furniture, inner walls.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

class Scene;

// Objects that contain a point of `inside` are left out: they are the hull of the room. The scene
// must outlive the result.
std::vector<const Mesh*> closed_objects(const Scene& scene, const std::vector<Vec3d>& inside);

}  // namespace rayloc
