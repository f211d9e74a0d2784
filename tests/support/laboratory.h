// A furnished laboratory of 10.8 x 5.6 x 3 m: 23 boxes (shell included), 276 triangles, an access
// point of three antennas, places of a device. The room in which the tracer's speed is stated.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/scene/antenna_array.h"
#include "engine/scene/scene.h"

namespace rayloc::test {

std::shared_ptr<const Scene> laboratory();

AntennaArray laboratory_access_point();

// Distinct places spread evenly over the room, 1.2 m high, 5 cm or more from everything. The first
// places are the same whatever `count`.
std::vector<Vec3d> laboratory_positions(std::size_t count);

}  // namespace rayloc::test
