#include "daemon/site/import/scanned_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/scene/build_room.h"
#include "daemon/site/scene/plan_rooms.h"

namespace rayloc {
namespace {

constexpr double kInWall = 0.3;             // [m], chosen: of an opening from its wall
constexpr double kMinUprightCosine = 0.98;  // cosine, chosen: 11 degrees
constexpr double kLeast = 0.01;             // [m], chosen: smaller walls and openings are ignored

// Rotation about the vertical axis and translation.
class Turn {
 public:
  Turn(double angle, const Vec3d& origin)
      : c_(std::cos(angle)), s_(std::sin(angle)), origin_(origin) {}
  Vec3d direction(const Vec3d& v) const { return {c_ * v.x - s_ * v.y, s_ * v.x + c_ * v.y, v.z}; }
  Vec3d point(const Vec3d& p) const { return direction(p) - origin_; }

 private:
  double c_;
  double s_;
  Vec3d origin_;
};

void turn(const Turn& by, std::vector<ScannedBox>& boxes) {
  for (ScannedBox& box : boxes) {
    box.centre = by.point(box.centre);
    box.x = by.direction(box.x);
    box.y = by.direction(box.y);
    box.z = by.direction(box.z);
  }
}

void turn(const Turn& by, ScannedRoom& room) {
  turn(by, room.walls);
  turn(by, room.openings);
  turn(by, room.objects);
  for (FloorPoint& p : room.floor) {
    const Vec3d rotated = by.point({p[0], p[1], 0.0});
    p = {rotated.x, rotated.y};
  }
}

Bounds bounds_of(const std::vector<ScannedBox>& walls) {
  Bounds bounds;
  for (const ScannedBox& wall : walls) {
    for (const double u : {-0.5, 0.5}) {
      for (const double v : {-0.5, 0.5}) {
        bounds.include(wall.centre + u * wall.size.x * wall.x + v * wall.size.y * wall.y);
      }
    }
  }
  return bounds;
}

// Aligns the longest wall with x, the lower left corner with the origin.
void put_straight(ScannedRoom& room, Model& model) {
  const ScannedBox& longest = *std::max_element(
      room.walls.begin(), room.walls.end(), [](const ScannedBox& a, const ScannedBox& b) {
        return a.size.x < b.size.x;
      });
  const double angle = std::remainder(std::atan2(longest.x.y, longest.x.x), std::numbers::pi);
  turn(Turn(-angle, {}), room);
  turn(Turn(0.0, bounds_of(room.walls).lower), room);
  model.remarks.push_back(
      fmt::format("rotated by {:.1f} degrees, so that its longest wall lies along x; the origin is "
                  "the lower left corner of the walls",
                  -angle * 180.0 / std::numbers::pi));
}

SheetFrame frame_of(const ScannedBox& wall) {
  return {
      wall.centre - 0.5 * wall.size.x * wall.x - 0.5 * wall.size.y * wall.y, wall.x, wall.y, false};
}

// Centre of the opening: along the wall, up it, and out of it.
Vec3d place_on_wall(const ScannedBox& wall, const ScannedBox& opening) {
  const Vec3d from = opening.centre - frame_of(wall).origin;
  return {dot(from, wall.x), dot(from, wall.y), dot(from, wall.z)};
}

// The wall that an opening names, else the nearest one around it; none: the number of walls.
std::size_t wall_of(const ScannedRoom& room, const ScannedBox& opening) {
  std::size_t found = room.walls.size();
  double nearest = kInWall;
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    const ScannedBox& wall = room.walls[i];
    if (!opening.parent.empty() && opening.parent == wall.id) {
      return i;
    }
    const Vec3d at = place_on_wall(wall, opening);
    const bool is_beside = at.x > 0.0 && at.x < wall.size.x && at.y > 0.0 && at.y < wall.size.y;
    if (is_beside && std::abs(at.z) < nearest &&
        std::abs(dot(wall.z, opening.z)) > kMinUprightCosine) {
      nearest = std::abs(at.z);
      found = i;
    }
  }
  return found;
}

class RoomMaker {
 public:
  explicit RoomMaker(ScannedRoom& room) : room_(room), holes_(room.walls.size()) {}

  Model make() {
    put_straight(room_, model_);
    for (const ScannedBox& opening : room_.openings) {
      cut(opening);
    }
    for (std::size_t i = 0; i < room_.walls.size(); ++i) {
      const ScannedBox& wall = room_.walls[i];
      if (wall.size.x > kLeast && wall.size.y > kLeast) {
        add(wall, sheet(wall, {}, {wall.size.x, wall.size.y}, holes_[i]));
      }
    }
    std::move(panes_.begin(), panes_.end(), std::back_inserter(model_.parts));
    add_floor();
    for (const ScannedBox& object : room_.objects) {
      add_object(object);
    }
    add_remarks();
    return std::move(model_);
  }

 private:
  static Mesh sheet(const ScannedBox& wall,
                    const FloorPoint& lower,
                    const FloorPoint& upper,
                    std::span<const PlanHole> holes) {
    const std::array<FloorPoint, 2> top{FloorPoint{lower[0], upper[1]}, upper};
    return sheet_mesh(frame_of(wall), lower[1], top, holes);
  }

  void add(const ScannedBox& box, Mesh mesh) {
    if (!mesh.triangles.empty()) {
      model_.parts.push_back({box.name, "", std::move(mesh), box.size.z});
    }
  }

  void cut(const ScannedBox& opening) {
    const std::size_t i = wall_of(room_, opening);
    if (i == room_.walls.size()) {
      ++astray_;
      return;
    }
    const ScannedBox& wall = room_.walls[i];
    const Vec3d at = place_on_wall(wall, opening);
    PlanHole hole;
    hole.lower = {std::clamp(at.x - 0.5 * opening.size.x, 0.0, wall.size.x),
                  std::clamp(at.y - 0.5 * opening.size.y, 0.0, wall.size.y)};
    hole.upper = {std::clamp(at.x + 0.5 * opening.size.x, 0.0, wall.size.x),
                  std::clamp(at.y + 0.5 * opening.size.y, 0.0, wall.size.y)};
    if (hole.upper[0] - hole.lower[0] < kLeast || hole.upper[1] - hole.lower[1] < kLeast) {
      ++astray_;
      return;
    }
    open_ += opening.is_open ? 1 : 0;
    if (!opening.is_open) {
      panes_.push_back({opening.name, "", sheet(wall, hole.lower, hole.upper, {}), opening.size.z});
    }
    holes_[i].push_back(std::move(hole));
  }

  void add_floor() {
    const Bounds walls = bounds_of(room_.walls);
    PlanRoom room{.outline = room_.floor, .level = walls.lower.z, .height = walls.upper.z};
    const bool has_outline = room.outline.size() > 2 && !outline_mistake(room.outline);
    if (!has_outline) {
      room.outline = {{walls.lower.x, walls.lower.y},
                      {walls.upper.x, walls.lower.y},
                      {walls.upper.x, walls.upper.y},
                      {walls.lower.x, walls.upper.y}};
    }
    model_.parts.push_back({"floor", "", floor_mesh(room)});
    model_.parts.push_back({"ceiling", "", ceiling_mesh(room)});
    model_.remarks.push_back(fmt::format(
        "floor and ceiling are {}, {:.2f} m apart",
        has_outline ? "the scan's outline of the floor" : "the rectangle around the walls",
        room.height - room.level));
  }

  void add_object(const ScannedBox& object) {
    if (std::abs(object.y.z) < kMinUprightCosine) {
      ++leaning_;
      return;
    }
    PlanBox box;
    box.centre = object.centre;
    box.size = {object.size.x, object.size.z, object.size.y};
    box.yaw = std::atan2(object.x.y, object.x.x);
    const int flat = (box.size.x < kLeast ? 1 : 0) + (box.size.y < kLeast ? 1 : 0) +
                     (box.size.z < kLeast ? 1 : 0);
    if (flat > 1) {
      ++leaning_;
      return;
    }
    for (double* side : {&box.size.x, &box.size.y, &box.size.z}) {
      *side = *side < kLeast ? 0.0 : *side;
    }
    model_.parts.push_back({object.name, "", box_mesh(box)});
  }

  void add_remarks() {
    model_.remarks.push_back(fmt::format(
        "{} walls, {} doors and windows that are closed, {} openings and open doors, {} "
        "pieces of furniture",
        room_.walls.size(),
        panes_.size(),
        open_,
        room_.objects.size() - leaning_));
    if (astray_ > 0) {
      model_.remarks.push_back(
          fmt::format("left out: {} doors, windows or openings that are in no wall", astray_));
    }
    if (leaning_ > 0) {
      model_.remarks.push_back(
          fmt::format("left out: {} pieces of furniture that lean or have no extent", leaning_));
    }
  }

  ScannedRoom& room_;
  Model model_;
  std::vector<std::vector<PlanHole>> holes_;  // by wall
  std::vector<ModelPart> panes_;
  int astray_ = 0;
  int open_ = 0;
  std::size_t leaning_ = 0;
};

}  // namespace

Expected<Model> scanned_room(ScannedRoom room) {
  if (room.walls.empty()) {
    return bad_input("has no wall; scan the room again, walking along its walls");
  }
  return RoomMaker(room).make();
}

}  // namespace rayloc
