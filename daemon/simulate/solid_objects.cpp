#include "daemon/simulate/solid_objects.h"

#include <algorithm>
#include <cstdint>

#include "engine/scene/scene.h"
#include "engine/scene/solid.h"

namespace rayloc {

SolidObjects::SolidObjects(const RoomModel& room) {
  const Scene& scene = *room.scene;
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    const Mesh& mesh = scene.objects()[i].mesh;
    const bool hull = std::any_of(
        room.access_points.begin(), room.access_points.end(), [&](const RoomAccessPoint& ap) {
          return is_inside(mesh, ap.array.pose.position);
        });
    if (!hull && scene.solid(i).shells > 0) {
      objects_.push_back({&mesh, bounds_of(mesh)});
    }
  }
}

bool SolidObjects::contain(const Vec3d& place) const {
  return std::any_of(objects_.begin(), objects_.end(), [&](const Object& object) {
    return object.bounds.contains(place) && is_inside(*object.mesh, place);
  });
}

}  // namespace rayloc
