#include "daemon/lab/simulate/solid_objects.h"

#include <algorithm>

#include "engine/scene/closed_objects.h"
#include "engine/scene/solid.h"

namespace rayloc {

SolidObjects::SolidObjects(const RoomModel& room) {
  std::vector<Vec3d> access_points;
  for (const RoomAccessPoint& ap : room.access_points) {
    access_points.push_back(ap.array.pose.position);
  }
  for (const Mesh* mesh : closed_objects(*room.scene, access_points)) {
    objects_.push_back({mesh, bounds_of(*mesh)});
  }
}

bool SolidObjects::contain(const Vec3d& place) const {
  return std::any_of(objects_.begin(), objects_.end(), [&](const Object& object) {
    return object.bounds.contains(place) && is_inside(*object.mesh, place);
  });
}

}  // namespace rayloc
