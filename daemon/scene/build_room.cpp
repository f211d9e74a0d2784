#include "daemon/scene/build_room.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/base/mat3.h"

namespace rayloc {
namespace {

// Cuts closer together than this are one; a triangle between them would be dropped as degenerate.
constexpr double kSameCut = 1e-5;  // [m]

// A side of the room: its rectangle in the coordinates (u, v) of two axes, at `level` of the third.
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

Vec3d lift(const Sheet& sheet, double u, double v) {
  std::array<double, 3> point{};
  point.at(sheet.u_axis) = u;
  point.at(sheet.v_axis) = v;
  point.at(sheet.normal_axis) = sheet.level;
  return {point[0], point[1], point[2]};
}

std::vector<double> cuts(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto same = [](double a, double b) { return b - a < kSameCut; };
  values.erase(std::unique(values.begin(), values.end(), same), values.end());
  return values;
}

bool is_open(const std::vector<PlanOpening>& openings, double u, double v) {
  return std::any_of(openings.begin(), openings.end(), [&](const PlanOpening& opening) {
    return u > opening.lower[0] && u < opening.upper[0] && v > opening.lower[1] &&
           v < opening.upper[1];
  });
}

// The rectangle without its openings: cut at every edge of them, so that all cells share their
// corners and coplanar neighbours leave no seam.
Mesh sheet_mesh(const Sheet& sheet, const std::vector<PlanOpening>& openings) {
  std::vector<double> u_cuts{sheet.lower[0], sheet.upper[0]};
  std::vector<double> v_cuts{sheet.lower[1], sheet.upper[1]};
  for (const PlanOpening& opening : openings) {
    u_cuts.insert(u_cuts.end(), {opening.lower[0], opening.upper[0]});
    v_cuts.insert(v_cuts.end(), {opening.lower[1], opening.upper[1]});
  }
  const std::vector<double> u = cuts(std::move(u_cuts));
  const std::vector<double> v = cuts(std::move(v_cuts));

  Mesh mesh;
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> corners;
  const auto corner = [&](std::size_t i, std::size_t j) {
    const auto next = static_cast<std::uint32_t>(mesh.vertices.size());
    const auto [found, added] = corners.try_emplace({i, j}, next);
    if (added) {
      mesh.vertices.push_back(lift(sheet, u[i], v[j]));
    }
    return found->second;
  };
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      if (is_open(openings, 0.5 * (u[i] + u[i + 1]), 0.5 * (v[j] + v[j + 1]))) {
        continue;
      }
      const std::uint32_t a = corner(i, j);
      const std::uint32_t b = sheet.flipped ? corner(i, j + 1) : corner(i + 1, j);
      const std::uint32_t c = corner(i + 1, j + 1);
      const std::uint32_t d = sheet.flipped ? corner(i + 1, j) : corner(i, j + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

// Twelve triangles, normals outwards; two where one size is 0.
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

// What closes an opening.
Mesh pane_mesh(const RoomPlan& plan, const PlanOpening& opening) {
  Sheet sheet = sheet_of(plan, opening.wall);
  sheet.lower = opening.lower;
  sheet.upper = opening.upper;
  return sheet_mesh(sheet, {});
}

}  // namespace

StatedScene build_room(const RoomPlan& plan) {
  StatedScene scene;
  scene.materials = plan.materials;
  for (std::size_t i = 0; i < kRoomSides.size(); ++i) {
    const auto side = static_cast<RoomSide>(i);
    std::vector<PlanOpening> openings;
    std::copy_if(plan.openings.begin(),
                 plan.openings.end(),
                 std::back_inserter(openings),
                 [side](const PlanOpening& opening) { return opening.wall == side; });
    Mesh mesh = sheet_mesh(sheet_of(plan, side), openings);
    if (!mesh.triangles.empty()) {  // an opening may be as large as its wall
      scene.objects.push_back(
          {std::string(kRoomSides.at(i)), plan.side_material.at(i), std::move(mesh)});
    }
  }
  for (const PlanOpening& opening : plan.openings) {
    if (!opening.material.empty()) {
      scene.objects.push_back({opening.name, opening.material, pane_mesh(plan, opening)});
    }
  }
  for (const PlanBox& box : plan.boxes) {
    scene.objects.push_back({box.name, box.material, box_mesh(box)});
  }
  return scene;
}

}  // namespace rayloc
