#include "engine/scene/closed_objects.h"

#include <algorithm>
#include <cstdint>

#include "engine/scene/scene.h"
#include "engine/scene/solid.h"

namespace rayloc {

std::vector<const Mesh*> closed_objects(const Scene& scene, const std::vector<Vec3d>& inside) {
  std::vector<const Mesh*> closed;
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    const Mesh& mesh = scene.objects()[i].mesh;
    const bool hull = std::any_of(
        inside.begin(), inside.end(), [&](const Vec3d& point) { return is_inside(mesh, point); });
    if (scene.solid(i).shells > 0 && !hull) {
      closed.push_back(&mesh);
    }
  }
  return closed;
}

}  // namespace rayloc
