#include "daemon/site/scene/build_room.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/mat3.h"

namespace rayloc {
namespace {

// A side of the room: a rectangle in the coordinates (u, v) of two axes, at `level` of the third.
struct Sheet {
  std::size_t u_axis, v_axis, normal_axis;
  double level;
  bool flipped;  // u x v points outwards
  std::array<double, 2> lower, upper;
};

std::array<double, 3> components(const Vec3d& v) { return {v.x, v.y, v.z}; }

Sheet sheet_of(const RoomPlan& plan, RoomSide side) {
  const auto low = components(plan.lower);
  const auto high = components(plan.upper);
  const auto make = [&](std::size_t u, std::size_t v, std::size_t normal, bool at_top, bool flip) {
    return Sheet{u,
                 v,
                 normal,
                 at_top ? high.at(normal) : low.at(normal),
                 flip,
                 {low.at(u), low.at(v)},
                 {high.at(u), high.at(v)}};
  };
  switch (side) {
    case RoomSide::kFloor:
      return make(0, 1, 2, false, false);
    case RoomSide::kCeiling:
      return make(0, 1, 2, true, true);
    case RoomSide::kWest:
      return make(1, 2, 0, false, false);
    case RoomSide::kEast:
      return make(1, 2, 0, true, true);
    case RoomSide::kSouth:
      return make(0, 2, 1, false, true);
    case RoomSide::kNorth:
      break;
  }
  return make(0, 2, 1, true, false);
}

Mesh mesh_of(const Sheet& sheet, const std::vector<PlanHole>& holes) {
  const auto axis = [](std::size_t number, double length) {
    std::array<double, 3> v{};
    v.at(number) = length;
    return Vec3d{v[0], v[1], v[2]};
  };
  const std::array<FloorPoint, 2> top{FloorPoint{sheet.lower[0], sheet.upper[1]},
                                      FloorPoint{sheet.upper[0], sheet.upper[1]}};
  return sheet_mesh({axis(sheet.normal_axis, sheet.level),
                     axis(sheet.u_axis, 1.0),
                     axis(sheet.v_axis, 1.0),
                     sheet.flipped},
                    sheet.lower[1],
                    top,
                    holes);
}

// The pane that closes an opening.
Mesh pane_mesh(Sheet sheet, const PlanHole& opening) {
  sheet.lower = opening.lower;
  sheet.upper = opening.upper;
  return mesh_of(sheet, {});
}

Mesh pane_mesh(const PlanWall& wall, const PlanHole& opening) {
  const std::array<FloorPoint, 2> top{FloorPoint{opening.lower[0], opening.upper[1]},
                                      FloorPoint{opening.upper[0], opening.upper[1]}};
  return sheet_mesh(frame_of(wall), opening.lower[1], top, {});
}

void add_sides(const RoomPlan& plan, StatedScene& scene) {
  for (std::size_t i = 0; i < kRoomSides.size(); ++i) {
    const auto side = static_cast<RoomSide>(i);
    std::vector<PlanHole> openings;
    for (const PlanOpening& opening : plan.openings) {
      if (opening.wall == side) {
        openings.push_back(opening);
      }
    }
    Mesh mesh = mesh_of(sheet_of(plan, side), openings);
    if (!mesh.triangles.empty()) {  // an opening may be as large as its wall
      scene.objects.push_back(
          {std::string(kRoomSides.at(i)), plan.side_material.at(i), std::move(mesh)});
    }
  }
}

void add_rooms(const RoomPlan& plan, StatedScene& scene) {
  for (const PlanRoom& room : plan.rooms) {
    scene.objects.push_back({name_in(room, "floor"), room.floor, floor_mesh(room)});
    scene.objects.push_back({name_in(room, "ceiling"), room.ceiling, ceiling_mesh(room)});
  }
}

void add_walls(const RoomPlan& plan, StatedScene& scene) {
  for (const PlanWall& wall : plan.walls) {
    Mesh mesh = sheet_mesh(frame_of(wall), plan.lower.z, wall.top, wall.holes);
    if (!mesh.triangles.empty()) {
      scene.objects.push_back({wall.name, wall.material, std::move(mesh)});
    }
  }
}

void add_panes(const RoomPlan& plan, StatedScene& scene) {
  for (const PlanOpening& opening : plan.openings) {
    if (!opening.material.empty()) {
      scene.objects.push_back(
          {opening.name, opening.material, pane_mesh(sheet_of(plan, opening.wall), opening)});
    }
  }
  for (const PlanWall& wall : plan.walls) {
    for (const PlanHole& hole : wall.holes) {
      if (!hole.material.empty()) {
        scene.objects.push_back({hole.name, hole.material, pane_mesh(wall, hole)});
      }
    }
  }
}

}  // namespace

Mesh box_mesh(const PlanBox& box) {
  const Mat3d world_from_box = rotation_from_yaw_pitch_roll(box.yaw, 0.0, 0.0);
  const auto size = components(box.size);
  const auto corner = [&](const std::array<double, 3>& sign) {
    return box.centre + world_from_box * Vec3d{0.5 * sign[0] * size[0],
                                               0.5 * sign[1] * size[1],
                                               0.5 * sign[2] * size[2]};
  };
  const auto flat = std::find(size.begin(), size.end(), 0.0);
  Mesh mesh;
  if (flat != size.end()) {
    const auto normal = static_cast<std::size_t>(flat - size.begin());
    std::array<double, 3> sign{};
    for (const auto& [u, v] : {std::pair{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
      sign.at((normal + 1) % 3) = u;
      sign.at((normal + 2) % 3) = v;
      mesh.vertices.push_back(corner(sign));
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  }
  for (unsigned i = 0; i < 8; ++i) {  // bit 0: +x, bit 1: +y, bit 2: +z
    mesh.vertices.push_back(corner(
        {(i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0, (i & 4U) != 0 ? 1.0 : -1.0}));
  }
  // Anticlockwise seen from outside: -z, +z, -y, +y, -x, +x.
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& [a, b, c, d] : kFaces) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

StatedScene build_room(const RoomPlan& plan) {
  StatedScene scene;
  scene.materials = plan.materials;
  if (plan.rooms.empty()) {
    add_sides(plan, scene);
  } else {
    add_rooms(plan, scene);
  }
  add_walls(plan, scene);
  add_panes(plan, scene);
  for (const PlanBox& box : plan.boxes) {
    scene.objects.push_back({box.name, box.material, box_mesh(box)});
  }
  return scene;
}

}  // namespace rayloc
