// FreeSpace: the cells of a room where a device can be, and the moves between neighbours that no
// wall or furniture is in the way of, at the height of the grid. A device is free to pass above a
// table that ends below it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/posterior/posterior.h"

namespace rayloc {

class Scene;

struct FreeSpace {
  RoomGrid grid;
  std::vector<std::uint8_t> free;    // 1: a device can be in the cell
  std::vector<std::uint8_t> link_x;  // 1: it can move to the next cell in x (grid.count_y further)
  std::vector<std::uint8_t> link_y;  // 1: it can move to the next cell in y (1 further)
};

// Cells inside a closed object are not free. An object around a place of `inside` (the access
// points') is the hull of the room, not a thing in it. When nothing would be free, the plan is
// not believed and everything is.
FreeSpace make_free_space(const Scene& scene,
                          const RoomGrid& grid,
                          const std::vector<Vec3d>& inside);

}  // namespace rayloc
