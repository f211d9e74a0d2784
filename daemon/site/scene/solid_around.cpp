#include "daemon/site/scene/solid_around.h"

#include <cmath>

#include "engine/scene/bounds.h"
#include "engine/scene/solid.h"

namespace rayloc {
namespace {

// True if it is as large as the whole scene.
bool is_shell(const Scene& scene, const Bounds& bounds) {
  return norm(bounds.lower - scene.bounds_min()) < kSameBounds &&
         norm(bounds.upper - scene.bounds_max()) < kSameBounds;
}

}  // namespace

std::optional<std::uint32_t> solid_around(const Scene& scene, const Vec3d& point) {
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    const Mesh& mesh = scene.objects()[i].mesh;
    // A solid angle of half a turn is a point on a face, up to rounding: not inside.
    const Bounds bounds = bounds_of(mesh);
    if (scene.solid(i).shells > 0 && bounds.contains(point) && !is_shell(scene, bounds) &&
        std::abs(winding_number(mesh, point)) > 0.75) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace rayloc
