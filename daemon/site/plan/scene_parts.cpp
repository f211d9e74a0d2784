#include "daemon/site/plan/scene_parts.h"

#include <algorithm>

namespace rayloc::draw {
namespace {

constexpr double kFlat = 0.5;          // [m]: floors, ceilings and walls are not thicker
constexpr double kLargeShare = 0.5;    // share of the plan: a floor or a ceiling
constexpr double kHighShare = 0.6;     // share of the height: a wall
constexpr double kShortestWall = 1.0;  // [m]

PartKind kind_of(const Bounds& part, const Bounds& all) {
  const Vec3d size = part.size();
  const Vec3d whole = all.size();
  if (size.z <= kFlat && size.x * size.y > kLargeShare * whole.x * whole.y) {
    const double middle = 0.5 * (part.lower.z + part.upper.z);
    return middle < 0.5 * (all.lower.z + all.upper.z) ? PartKind::kFloor : PartKind::kCeiling;
  }
  const double thin = std::min(size.x, size.y);
  const double wide = std::max(size.x, size.y);
  const bool is_wall =
      size.z > kHighShare * whole.z && thin <= kFlat && wide >= kShortestWall && wide > 3.0 * thin;
  return is_wall ? PartKind::kWall : PartKind::kFurniture;
}

}  // namespace

std::vector<ScenePart> scene_parts(const Scene& scene) {
  const Bounds all{scene.bounds_min(), scene.bounds_max()};
  std::vector<ScenePart> parts;
  for (const SceneObject& object : scene.objects()) {
    const Bounds bounds = bounds_of(object.mesh);
    parts.push_back(
        {kind_of(bounds, all), bounds, object.name, scene.materials()[object.material].name});
  }
  return parts;
}

}  // namespace rayloc::draw
