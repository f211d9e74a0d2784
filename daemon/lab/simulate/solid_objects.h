// SolidObjects: the interior of objects in a room, where no device can be.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"
#include "engine/scene/bounds.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// The closed objects of the room's scene, except one around an access point, which is the hull of
// the room. The scene must outlive it.
class SolidObjects {
 public:
  explicit SolidObjects(const RoomModel& room);

  bool contain(const Vec3d& place) const;

 private:
  struct Object {
    const Mesh* mesh;
    Bounds bounds;
  };
  std::vector<Object> objects_;
};

}  // namespace rayloc
