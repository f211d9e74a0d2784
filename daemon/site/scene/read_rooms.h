// RoomReader: the rooms, walls and slopes of a room plan. Only room_plan.cpp uses this.
//
// Errors are noted in the plan's document (toml_reader.h).
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/site/model/toml_reader.h"
#include "daemon/site/scene/plan_materials.h"
#include "daemon/site/scene/room_plan.h"

namespace rayloc {

// Tolerance for walls, furniture and openings that touch others: sums of decimal numbers round.
inline constexpr double kTouchingDistance = 1e-6;  // [m]

// A name of an object: valid as the name of a mesh file, and unique.
std::string read_object_name(const TomlTable& table, std::set<std::string>& names);

// A plan that states `outline` or [[room]] in place of `size`.
bool has_outlines(const TomlTable& root);

class RoomReader {
 public:
  // `names`: names of all objects of the plan.
  RoomReader(const TomlTable& root,
             PlanMaterials& materials,
             std::set<std::string>& names,
             RoomPlan& plan)
      : root_(root), materials_(materials), names_(names), plan_(plan) {}

  // Reads the rooms of a plan with outlines, their walls, and the box around them; returns false
  // after an error that leaves the rooms undefined.
  bool read_rooms();
  // [[partition]]. `rooms`: those that walls may be in; empty if the rooms are undefined.
  void read_partitions(const std::vector<PlanRoom>& rooms);

 private:
  // Values of a room, read before its ceiling is determined.
  struct Stated {
    PlanRoom room;
    std::vector<std::string> walls;  // materials of the walls
  };

  void read_defaults(bool needed);
  void read_room(const TomlTable& table);
  std::string material(const TomlTable& table, std::string_view key, const std::string& otherwise);
  bool read_outline(const TomlTable& table, PlanRoom& room);
  void read_slope(const TomlTable& table);
  bool check_ceilings();
  void check_apart(const TomlTable& table, const PlanRoom& room);
  void add_walls_of(const Stated& stated);

  const TomlTable& root_;
  PlanMaterials& materials_;
  std::set<std::string>& names_;
  RoomPlan& plan_;
  std::vector<Stated> stated_;
  double default_height_ = 0.0;
  std::string default_floor_, default_ceiling_, default_walls_;
  bool sound_ = true;
};

}  // namespace rayloc
