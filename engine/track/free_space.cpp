#include "engine/track/free_space.h"

#include <algorithm>

#include "engine/base/parallel.h"
#include "engine/scene/closed_objects.h"
#include "engine/scene/scene.h"
#include "engine/scene/solid.h"

namespace rayloc {
FreeSpace make_free_space(const Scene& scene, const Grid& grid, const std::vector<Vec3d>& inside) {
  FreeSpace space{grid,
                  std::vector<std::uint8_t>(grid.size(), 1),
                  std::vector<std::uint8_t>(grid.size(), 0),
                  std::vector<std::uint8_t>(grid.size(), 0)};
  const auto things = closed_objects(scene, inside);
  parallel_for(grid.size(), 64, [&](std::size_t cell) {
    const Vec3d centre = grid.centre(cell);
    space.free[cell] = std::none_of(
        things.begin(), things.end(), [&](const Mesh* thing) { return is_inside(*thing, centre); });
  });
  if (std::none_of(space.free.begin(), space.free.end(), [](std::uint8_t f) { return f != 0; })) {
    std::fill(space.free.begin(), space.free.end(), std::uint8_t{1});
  }
  const auto is_open = [&](std::size_t from, std::size_t to) {
    return space.free[from] != 0 && space.free[to] != 0 &&
           !scene.is_blocked({grid.centre(from), grid.centre(to)});
  };
  parallel_for(grid.size(), 64, [&](std::size_t cell) {
    space.link_x[cell] =
        cell + grid.count_y < grid.size() && is_open(cell, cell + grid.count_y) ? 1 : 0;
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 && is_open(cell, cell + 1) ? 1 : 0;
  });
  return space;
}

}  // namespace rayloc
