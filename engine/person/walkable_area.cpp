#include "engine/person/walkable_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/scene/movable.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr double kFeet = 0.1;  // [m]: carpets and thresholds are stepped over
// A person comes nearer to objects than the body's radius: plans are centimetres off, people soft.
constexpr double kElbowRoom = 0.5;  // of the radius
constexpr int kDirections = 8;      // a count, chosen: 45 degrees apart, on the rim of a body

// Obstacles for a body at a place: surfaces of fixed objects that its axis would cut, or an object
// all around it.
class Obstacles {
 public:
  Obstacles(const RoomModel& room, const TargetBody& body)
      : scene_(*room.scene),
        low_(room.bounds_min.z + kFeet),
        high_(std::min(body.base + body.height, room.bounds_max.z - kFeet)),
        blocks_(scene_.objects().size()) {
    for (std::uint32_t i = 0; i < scene_.objects().size(); ++i) {
      const Mesh& mesh = scene_.objects()[i].mesh;
      const Bounds box = bounds_of(mesh);
      blocks_[i] = box.upper.z > low_ && box.lower.z < high_ && !is_movable(box, room.bounds_min.z);
      // An object around an access point is the hull of the room.
      const bool hull = std::any_of(
          room.access_points.begin(), room.access_points.end(), [&](const RoomAccessPoint& ap) {
            return is_inside(mesh, ap.array.pose.position);
          });
      if (blocks_[i] != 0 && !hull && scene_.solid(i).shells > 0) {
        solids_.push_back(&mesh);
      }
    }
  }

  bool is_free(double x, double y) const {
    std::vector<Crossing> crossed;
    scene_.crossings({{x, y, low_}, {x, y, high_}}, crossed);
    const bool cut = std::any_of(crossed.begin(), crossed.end(), [&](const Crossing& crossing) {
      return blocks_[scene_.owner(crossing.surface).object] != 0;
    });
    return !cut && std::none_of(solids_.begin(), solids_.end(), [&](const Mesh* solid) {
      return is_inside(*solid, {x, y, 0.5 * (low_ + high_)});
    });
  }

 private:
  const Scene& scene_;
  double low_;
  double high_;
  std::vector<std::uint8_t> blocks_;  // for each object
  std::vector<const Mesh*> solids_;
};

Grid make_grid(const RoomModel& room, const std::optional<PersonArea>& area, double step) {
  Vec3d low = room.bounds_min;
  Vec3d high = room.bounds_max;
  if (area) {
    low.x = std::max(low.x, area->x - area->radius);
    low.y = std::max(low.y, area->y - area->radius);
    high.x = std::min(high.x, area->x + area->radius);
    high.y = std::min(high.y, area->y + area->radius);
  }
  if (!(low.x < high.x && low.y < high.y)) {
    low = room.bounds_min;
    high = room.bounds_max;
  }
  return {low, high, room.bounds_min.z, step};
}

}  // namespace

WalkableArea make_walkable_area(const RoomModel& room,
                                const TargetBody& body,
                                const std::optional<PersonArea>& area,
                                double step) {
  WalkableArea walkable{make_grid(room, area, step), {}};
  const Grid& grid = walkable.grid;
  walkable.free.assign(grid.size(), 1);
  const Obstacles obstacles(room, body);
  const double reach = kElbowRoom * std::min(body.semi_axes[0], body.semi_axes[1]);
  const auto is_free = [&](const Vec3d& centre) {
    if (area && std::hypot(centre.x - area->x, centre.y - area->y) > area->radius) {
      return false;
    }
    for (int i = -1; i < kDirections; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kDirections;
      const double r = i < 0 ? 0.0 : reach;
      const double x = centre.x + r * std::cos(angle);
      const double y = centre.y + r * std::sin(angle);
      if (x < room.bounds_min.x || x > room.bounds_max.x || y < room.bounds_min.y ||
          y > room.bounds_max.y || !obstacles.is_free(x, y)) {
        return false;
      }
    }
    return true;
  };
  parallel_for(grid.size(), 64, [&](std::size_t cell) {
    walkable.free[cell] = is_free(grid.centre(cell)) ? 1 : 0;
  });
  if (std::none_of(
          walkable.free.begin(), walkable.free.end(), [](std::uint8_t f) { return f != 0; })) {
    std::fill(walkable.free.begin(), walkable.free.end(), std::uint8_t{1});
  }
  return walkable;
}

}  // namespace rayloc
