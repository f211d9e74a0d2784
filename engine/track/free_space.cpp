#include "engine/track/free_space.h"

#include <algorithm>

#include "engine/base/parallel.h"
#include "engine/localize/localizer.h"
#include "engine/scene/closed_objects.h"
#include "engine/scene/scene.h"
#include "engine/scene/solid.h"

namespace rayloc {
namespace {

// `steps` links of one direction from a cell on, `stride` cells apart.
bool has_open_links(const std::vector<std::uint8_t>& links,
                    std::size_t first,
                    std::size_t steps,
                    std::size_t stride) {
  for (std::size_t n = 0; n < steps; ++n) {
    if (links[first + n * stride] == 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

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
  const auto is_linked = [&](std::size_t from, std::size_t to) {
    return space.free[from] != 0 && space.free[to] != 0 &&
           !scene.is_blocked({grid.centre(from), grid.centre(to)});
  };
  parallel_for(grid.size(), 64, [&](std::size_t cell) {
    space.link_x[cell] =
        cell + grid.count_y < grid.size() && is_linked(cell, cell + grid.count_y) ? 1 : 0;
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 && is_linked(cell, cell + 1) ? 1 : 0;
  });
  return space;
}

FreeSpace make_free_space(const Localizer& localizer) {
  std::vector<Vec3d> access_points;
  for (const RoomAccessPoint& ap : localizer.room().access_points) {
    access_points.push_back(ap.array.pose.position);
  }
  return make_free_space(*localizer.room().scene, localizer.grid(), access_points);
}

bool is_open(const FreeSpace& space, std::size_t from, std::size_t to) {
  const std::size_t count_y = space.grid.count_y;
  const std::size_t from_x = from / count_y;
  const std::size_t from_y = from % count_y;
  const std::size_t to_x = to / count_y;
  const std::size_t to_y = to % count_y;
  const std::size_t low_x = std::min(from_x, to_x);
  const std::size_t low_y = std::min(from_y, to_y);
  const std::size_t steps_x = std::max(from_x, to_x) - low_x;
  const std::size_t steps_y = std::max(from_y, to_y) - low_y;
  const auto along_x = [&](std::size_t row) {
    return has_open_links(space.link_x, low_x * count_y + row, steps_x, count_y);
  };
  const auto along_y = [&](std::size_t column) {
    return has_open_links(space.link_y, column * count_y + low_y, steps_y, 1);
  };
  return space.free[from] != 0 && space.free[to] != 0 &&
         ((along_x(from_y) && along_y(to_x)) || (along_y(from_x) && along_x(to_y)));
}

}  // namespace rayloc
