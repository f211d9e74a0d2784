// A furnished laboratory of 10.8 x 5.6 x 3 m: 23 boxes (shell included), 276 triangles, an access
// point of three antennas, positions of a device. The tracer's speed is stated for this room.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/scene/antenna_array.h"
#include "engine/scene/scene.h"

namespace rayloc::test {

std::shared_ptr<const Scene> laboratory();

AntennaArray laboratory_access_point();

// Distinct positions spread evenly over the room, 1.2 m high, 5 cm or more from every object. The
// first positions are the same for any `count`.
std::vector<Vec3d> laboratory_positions(std::size_t count);

}  // namespace rayloc::test
