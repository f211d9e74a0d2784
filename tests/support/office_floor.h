// An office floor of any size: rows of rooms with a desk, a chair and a cupboard each, doors to a
// corridor, all built of boxes. The tracer's scaling with scene size is stated on such floors.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::test {

// The largest whole number of boxes (of 12 triangles) within `triangles`, at least 8; rooms are
// filled one after the other.
std::shared_ptr<const Scene> office_floor(std::size_t triangles);

// Two positions in the first room, of an access point and of a device; and one in the
// corridor in front of it, which has a view into the room through its door.
Vec3d office_access_point();
Vec3d office_device();
Vec3d office_corridor();

}  // namespace rayloc::test
