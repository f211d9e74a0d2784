// FreeSpace: cells of a room that a device can occupy, and the moves between neighbours that no
// wall or furniture blocks, at the height of the grid. A device can pass above a table that ends
// below it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/grid/grid.h"

namespace rayloc {

class Localizer;
class Scene;

struct FreeSpace {
  Grid grid;
  std::vector<std::uint8_t> free;    // 1: a device can be in the cell
  std::vector<std::uint8_t> link_x;  // 1: it can move to the next cell in x (grid.count_y further)
  std::vector<std::uint8_t> link_y;  // 1: it can move to the next cell in y (1 further)
};

// Cells inside a closed object are not free. An object around a position of `inside` (the access
// points') is the hull of the room, not an obstacle. When no cell would be free, the plan is
// rejected and every cell is free.
FreeSpace make_free_space(const Scene& scene, const Grid& grid, const std::vector<Vec3d>& inside);
// That of a room and its grid.
FreeSpace make_free_space(const Localizer& localizer);

// True if a target can move between these cells of the grid over open links, first along x and then
// along y, or first along y. Paths around several corners are not found, so it is meant for cells
// at most 8 apart in each direction.
bool is_open(const FreeSpace& space, std::size_t from, std::size_t to);

}  // namespace rayloc
