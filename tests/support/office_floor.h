// An office floor of any size: rows of rooms with a desk, a chair and a cupboard each, doors to a
// corridor, all of boxes. How the tracer grows with the scene is stated on such floors.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::test {

// The largest whole number of boxes (of 12 triangles) that `triangles` allow, at least 8; rooms are
// filled one after the other.
std::shared_ptr<const Scene> office_floor(std::size_t triangles);

// Two places of the first room, that of an access point and that of a device; and one in the
// corridor before it, which sees the room through its door.
Vec3d office_access_point();
Vec3d office_device();
Vec3d office_corridor();

}  // namespace rayloc::test
