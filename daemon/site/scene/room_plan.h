// RoomPlan: a room stated in a few lines of TOML, for a user with a floor plan and without a scene.
//
//   name = "office"
//   size = [5.2, 3.4, 2.7]        # inside, along x, y, z
//   corner = [0, 0, 0]            # optional: the smallest x, y, z
//   floor = "concrete"            # materials: names of ITU-R P.2040-4, or of [materials.NAME]
//   ceiling = "ceiling_board"
//   walls = "plasterboard"
//   wall_north = "brick"          # optional, also wall_west (-x), wall_east (+x), wall_south (-y)
//
//   [[opening]]                   # a door, a window, a hole
//   name = "door"
//   wall = "east"
//   centre = [1.0, 1.0]           # along the wall (its x or y), height
//   size = [0.9, 2.0]
//   material = "wood"             # if omitted: a hole
//
//   [[box]]                       # furniture
//   name = "table"
//   material = "wood"
//   centre = [2.0, 1.5, 0.73]
//   size = [1.8, 0.9, 0.05]       # one of them may be 0: a sheet
//   yaw_deg = 20                  # optional
//
//   [[partition]]                 # a wall within the room
//   name = "partition"
//   from = [3, 0]
//   to = [3, 2.5]
//   material = "plasterboard"
//   height = 2.2                  # optional; default: to the ceiling
//
//   [materials.plasterboard]      # optional; default thickness 0.1 m
//   thickness_m = 0.0125
//   [materials.outer]
//   itu = "brick"                 # or relative_permittivity and conductivity
//
// In place of `size` and `corner`, a room of any outline; its walls are wall_1 (from the first
// corner to the second), wall_2, ..., each of which may have a material of its own:
//
//   outline = [[0, 0], [6, 0], [6, 4], [3, 5.5], [0, 4]]   # corners, in either orientation
//   height = 2.7
//   wall_3 = "glass"
//
//   [[slope]]                     # a part of the ceiling that slopes: three points of its plane
//   from = [0, 0, 1.2]
//   to = [0, 4, 1.2]
//   through = [2, 0, 2.7]
//   room = "attic"                # optional; default: all rooms
//
// Several rooms are [[room]] tables with a `name` and an `outline`, and the values of height,
// floor, ceiling, walls and wall_N that differ from the file's. Their walls are kitchen_wall_1,
// ...; a wall that two rooms share belongs to the first.
//
// [carrier] and [[access_point]] may follow as in site.toml. Lengths are metres, z points up.
// Errors name file:line:column, all of them at once; unknown keys are errors.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/model/site.h"
#include "daemon/site/scene/plan_rooms.h"
#include "daemon/site/scene/scene_files.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"

namespace rayloc {

// The six sheets of the room, in the order of `kRoomSides`.
enum class RoomSide : std::uint8_t { kFloor, kCeiling, kWest, kEast, kSouth, kNorth };
inline constexpr std::array<std::string_view, 6> kRoomSides = {
    "floor", "ceiling", "wall_west", "wall_east", "wall_south", "wall_north"};

// In a side of the room; `lower` and `upper` along it are room coordinates.
struct PlanOpening : PlanHole {
  RoomSide wall = RoomSide::kWest;
};

struct PlanBox {
  std::string name;
  std::string material;
  Vec3d centre;
  Vec3d size;        // at most one is 0
  double yaw = 0.0;  // [rad]
};

struct RoomPlan {
  std::string name;
  Vec3d lower;  // [m], the corners of the room, or of the smallest box around all rooms
  Vec3d upper;
  std::array<std::string, kRoomSides.size()> side_material;  // for a plan with a size
  std::vector<PlanOpening> openings;                         // in those sides
  std::vector<PlanRoom> rooms;                               // for a plan with outlines
  std::vector<PlanWall> walls;                               // walls of those rooms, and partitions
  std::vector<PlanBox> boxes;
  std::vector<StatedMaterial> materials;  // the used ones, by name
  Carrier carrier;                        // default: 40 MHz at channel 36
  std::vector<SiteAccessPoint> access_points;
};

// 40 MHz at channel 36.
Carrier usual_carrier();

Expected<RoomPlan> load_room_plan(const std::filesystem::path& file);
// Parses a text; `file` is used in messages.
Expected<RoomPlan> parse_room_plan(std::string_view text, const std::filesystem::path& file);

}  // namespace rayloc
