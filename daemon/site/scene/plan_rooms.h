// Rooms of any outline: their walls and sloping ceilings, converted to sheets.
//
// A wall is upright on a line of the floor; its upper edge is at the ceiling. Rooms may share a
// wall: it exists once, as high as the higher room.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/outline.h"
#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// A rectangle in a wall: an opening, or a stretch that belongs to another room's wall.
struct PlanHole {
  std::string name;
  FloorPoint lower{};  // [m]: along the wall, height
  FloorPoint upper{};
  std::string material{};  // empty: a hole
};

struct PlanWall {
  std::string name;
  std::string material;
  FloorPoint from{};  // [m]
  FloorPoint to{};
  bool faces_left = true;         // seen along the direction from one end to the other
  std::vector<FloorPoint> top{};  // the upper edge from end to end: along the wall, height [m]
  std::vector<PlanHole> holes{};

  double length() const;
};

// The ceiling is no higher than along_x * x + along_y * y + at_origin.
struct PlanSlope {
  double along_x = 0.0;
  double along_y = 0.0;
  double at_origin = 0.0;  // [m]

  double at(const FloorPoint& p) const { return along_x * p[0] + along_y * p[1] + at_origin; }
};

struct PlanRoom {
  std::string name{};               // empty: the only room
  std::vector<FloorPoint> outline;  // in either orientation
  double level = 0.0;               // [m], height of the floor
  double height = 0.0;              // [m], height of the ceiling where it does not slope
  std::vector<PlanSlope> slopes{};
  std::string floor{};  // materials
  std::string ceiling{};

  double ceiling_at(const FloorPoint& p) const;
};

// "floor" of the only room, "kitchen_floor" of a room with a name.
std::string name_in(const PlanRoom& room, const std::string& part);

inline constexpr std::size_t kMaxOutlineCorners = 256;
// The error of the outline, with a remedy.
std::optional<std::string> outline_mistake(std::span<const FloorPoint> outline);

// The upper edge of a wall from one point of the room to another, no higher than `highest`.
std::vector<FloorPoint> upper_edge(const PlanRoom& room,
                                   const FloorPoint& from,
                                   const FloorPoint& to,
                                   double highest);

// The lowest height of the edge between two distances along the wall.
double lowest_between(std::span<const FloorPoint> top, double lower, double upper);

// Appends a wall; the stretches that coincide with walls of
// `walls` become its holes, and those walls become as high as it.
void add_wall(PlanWall wall, std::vector<PlanWall>& walls);

// Triangles of the floor, facing up, and of the ceiling, facing down.
Mesh floor_mesh(const PlanRoom& room);
Mesh ceiling_mesh(const PlanRoom& room);

// Coordinate frame of a sheet: a point is at origin + u * u_axis + v * v_axis.
struct SheetFrame {
  Vec3d origin;
  Vec3d u_axis;
  Vec3d v_axis;
  bool flipped;  // the triangles face against u_axis x v_axis
};
SheetFrame frame_of(const PlanWall& wall);

// The sheet between `bottom` and the edge `top` without its holes: cut at every edge of them, so
// that all cells share their corners and coplanar neighbours leave no seam.
Mesh sheet_mesh(const SheetFrame& frame,
                double bottom,
                std::span<const FloorPoint> top,
                std::span<const PlanHole> holes);

}  // namespace rayloc
