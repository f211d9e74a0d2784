#include "engine/track/free_space.h"

#include <algorithm>

#include "engine/base/parallel.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

std::vector<const Mesh*> things_of(const Scene& scene, const std::vector<Vec3d>& inside) {
  std::vector<const Mesh*> things;
  for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
    const Mesh& mesh = scene.objects()[i].mesh;
    const bool hull = std::any_of(
        inside.begin(), inside.end(), [&](const Vec3d& point) { return is_inside(mesh, point); });
    if (scene.solid(i).shells > 0 && !hull) {
      things.push_back(&mesh);
    }
  }
  return things;
}

}  // namespace

FreeSpace make_free_space(const Scene& scene,
                          const RoomGrid& grid,
                          const std::vector<Vec3d>& inside) {
  FreeSpace space{grid,
                  std::vector<std::uint8_t>(grid.size(), 1),
                  std::vector<std::uint8_t>(grid.size(), 0),
                  std::vector<std::uint8_t>(grid.size(), 0)};
  const auto things = things_of(scene, inside);
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
