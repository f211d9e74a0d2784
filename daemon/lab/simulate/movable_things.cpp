#include "daemon/lab/simulate/movable_things.h"

#include <algorithm>

#include "engine/scene/movable.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr double kTogether = 0.01;       // [m]: largest gap between parts of one thing
constexpr double kFlat = 0.06;           // [m]: a thinner object on a wall is part of the wall
constexpr double kAtWall = 0.03;         // [m]
constexpr double kTouch = 1e-3;          // [m]: less is no collision; feet touch floors
constexpr double kClearOfAntenna = 0.1;  // [m]

Bounds moved(const Bounds& bounds, const Vec3d& by) {
  Bounds result = bounds;
  result.lower = bounds.lower + by;
  result.upper = bounds.upper + by;
  return result;
}

Bounds widened(const Bounds& bounds, double margin) {
  Bounds result = bounds;
  result.lower = bounds.lower - Vec3d{margin, margin, margin};
  result.upper = bounds.upper + Vec3d{margin, margin, margin};
  return result;
}

bool meet(const Bounds& a, const Bounds& b) {
  return a.lower.x < b.upper.x && b.lower.x < a.upper.x && a.lower.y < b.upper.y &&
         b.lower.y < a.upper.y && a.lower.z < b.upper.z && b.lower.z < a.upper.z;
}

bool hangs_on_wall(const Bounds& thing, const RoomModel& room) {
  const Vec3d size = thing.size();
  const bool along_y = size.x < kFlat && (thing.lower.x < room.bounds_min.x + kAtWall ||
                                          thing.upper.x > room.bounds_max.x - kAtWall);
  const bool along_x = size.y < kFlat && (thing.lower.y < room.bounds_min.y + kAtWall ||
                                          thing.upper.y > room.bounds_max.y - kAtWall);
  return along_x || along_y;
}

}  // namespace

MovableThings::MovableThings(const RoomModel& room)
    : lower_(room.bounds_min), upper_(room.bounds_max) {
  for (const RoomAccessPoint& ap : room.access_points) {
    access_points_.push_back(ap.array.pose.position);
  }
  std::vector<std::uint32_t> left;
  for (const SceneObject& object : room.scene->objects()) {
    objects_.push_back(bounds_of(object.mesh));
    if (is_movable(objects_.back(), lower_.z)) {
      left.push_back(static_cast<std::uint32_t>(objects_.size() - 1));
    }
  }
  while (!left.empty()) {
    std::vector<std::uint32_t> thing = {left.front()};
    left.erase(left.begin());
    for (std::size_t i = 0; i < thing.size(); ++i) {
      const Bounds near = widened(objects_[thing[i]], kTogether);
      const auto apart = std::stable_partition(left.begin(), left.end(), [&](std::uint32_t other) {
        return meet(near, objects_[other]);
      });
      thing.insert(thing.end(), left.begin(), apart);
      left.erase(left.begin(), apart);
    }
    Bounds whole;
    for (const std::uint32_t object : thing) {
      whole.include(objects_[object].lower);
      whole.include(objects_[object].upper);
    }
    if (!hangs_on_wall(whole, room)) {
      things_.push_back(std::move(thing));
    }
  }
}

bool MovableThings::fits(std::size_t thing, const Vec3d& by) const {
  const std::vector<std::uint32_t>& parts = things_[thing];
  return std::all_of(parts.begin(), parts.end(), [&](std::uint32_t part) {
    const Bounds& before = objects_[part];
    const Bounds after = moved(before, by);
    if (after.lower.x < lower_.x || after.lower.y < lower_.y || after.upper.x > upper_.x ||
        after.upper.y > upper_.y) {
      return false;
    }
    const Bounds near = widened(after, kClearOfAntenna);
    if (std::any_of(access_points_.begin(), access_points_.end(), [&](const Vec3d& antenna) {
          return near.contains(antenna);
        })) {
      return false;
    }
    const Bounds body = widened(after, -kTouch);
    for (std::uint32_t other = 0; other < objects_.size(); ++other) {
      const Bounds& bounds = objects_[other];
      const bool own = std::find(parts.begin(), parts.end(), other) != parts.end();
      // An object all around the thing is the hull of the room.
      const bool around = bounds.contains(before.lower) && bounds.contains(before.upper);
      if (!own && !around && meet(body, bounds)) {
        return false;
      }
    }
    return true;
  });
}

void MovableThings::move(std::size_t thing, const Vec3d& by) {
  for (const std::uint32_t part : things_[thing]) {
    objects_[part] = moved(objects_[part], by);
  }
}

}  // namespace rayloc
