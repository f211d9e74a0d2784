#include "daemon/site/scene/read_rooms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "daemon/site/model/keys/site_limits.h"

namespace rayloc {
namespace {

constexpr NumberRange kHeight{0.1, 1e3, "m"};
constexpr double kMinLength = 1e-3;  // [m]; shorter ones are typing errors
// A steeper plane is a wall [m per metre].
constexpr double kSteepest = 20.0;
constexpr std::string_view kOutlineExample = "outline = [[0, 0], [6, 0], [6, 4], [0, 4]]";

std::string wall_key(std::size_t number) { return "wall_" + std::to_string(number + 1); }

FloorPoint between(const FloorPoint& a, const FloorPoint& b, double share) {
  return {a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])};
}

constexpr double kInside = 2e-3;  // [m], twice the distance at which two walls are one

// True if both ends of a wall are well off the line of the other one, on opposite sides.
bool is_cut(const FloorPoint& from,
            const FloorPoint& to,
            const FloorPoint& a,
            const FloorPoint& b) {
  const double x = to[0] - from[0];
  const double y = to[1] - from[1];
  const double length = std::hypot(x, y);
  const auto off = [&](const FloorPoint& p) {
    return (x * (p[1] - from[1]) - y * (p[0] - from[0])) / length;
  };
  return (off(a) < -kInside && off(b) > kInside) || (off(a) > kInside && off(b) < -kInside);
}

// True if the rooms overlap: a wall crosses one of the other room's walls, or a corner or the
// middle of a wall is well inside.
bool overlap(const PlanRoom& one, const PlanRoom& other) {
  for (const auto& [of, in] : {std::pair{&one, &other}, std::pair{&other, &one}}) {
    const std::size_t n = of->outline.size();
    const std::size_t m = in->outline.size();
    for (std::size_t i = 0; i < n; ++i) {
      const FloorPoint& a = of->outline[i];
      const FloorPoint& b = of->outline[(i + 1) % n];
      for (std::size_t j = 0; j < m; ++j) {
        const FloorPoint& c = in->outline[j];
        const FloorPoint& d = in->outline[(j + 1) % m];
        if (is_cut(a, b, c, d) && is_cut(c, d, a, b)) {
          return true;
        }
      }
      for (const FloorPoint& p : {a, between(a, b, 0.5)}) {
        bool near_wall = false;
        for (std::size_t j = 0; j < m; ++j) {
          near_wall =
              near_wall ||
              distance_from_edge(in->outline[j], in->outline[(j + 1) % m], p).across < kInside;
        }
        if (!near_wall && is_within(in->outline, p, 0.0)) {
          return true;
        }
      }
    }
  }
  return std::abs(signed_area(one.outline)) > 0.0 && one.outline == other.outline;
}

}  // namespace

std::string read_object_name(const TomlTable& table, std::set<std::string>& names) {
  const std::optional<std::string> name = table.string("name");
  if (!name) {
    return "";
  }
  if (!is_object_name(*name)) {
    table.error_at("name", "'name' is '" + *name + "'; write letters, digits, '-' and '_' only");
  } else if (!names.insert(*name).second) {
    table.error_at("name", "a second object '" + *name + "'; give each its own name");
  }
  return *name;
}

bool has_outlines(const TomlTable& root) { return root.has("outline") || root.has("room"); }

bool RoomReader::read_rooms() {
  if (root_.has("size")) {
    root_.ask_for("size");
    root_.error_at("size", "'size' is of a room with four walls; write it, or outlines");
    sound_ = false;
  }
  const bool single = root_.has("outline");
  read_defaults(single);
  if (single) {
    if (root_.has("room")) {
      root_.error_at("outline", "'outline' is of the only room; write it into a [[room]] as well");
    }
    read_room(root_);
  } else {
    for (const TomlTable& table : root_.tables("room")) {
      table.require({{"name", "name = \"kitchen\""}});
      read_room(table);
    }
    if (stated_.empty() && sound_) {
      root_.error_at("room", "'room' is empty; write a [[room]] with its outline");
      sound_ = false;
    }
  }
  for (const TomlTable& table : root_.tables("slope")) {
    read_slope(table);
  }
  if (!sound_ || !check_ceilings()) {
    return false;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  plan_.lower = {kInfinity, kInfinity, 0.0};
  plan_.upper = {-kInfinity, -kInfinity, 0.0};
  for (const Stated& stated : stated_) {
    add_walls_of(stated);
    for (const FloorPoint& p : stated.room.outline) {
      plan_.lower = {std::min(plan_.lower.x, p[0]), std::min(plan_.lower.y, p[1]), 0.0};
      plan_.upper = {std::max(plan_.upper.x, p[0]),
                     std::max(plan_.upper.y, p[1]),
                     std::max(plan_.upper.z, stated.room.height)};
    }
    names_.insert({name_in(stated.room, "floor"), name_in(stated.room, "ceiling")});
    plan_.rooms.push_back(stated.room);
  }
  return true;
}

void RoomReader::read_defaults(bool needed) {
  if (needed) {
    root_.require({{"height", "height = 2.7"},
                   {"floor", "floor = \"concrete\""},
                   {"ceiling", "ceiling = \"ceiling_board\""}});
  }
  default_height_ = root_.number("height", kHeight).value_or(0.0);
  default_floor_ = materials_.use(root_, "floor").value_or("");
  default_ceiling_ = materials_.use(root_, "ceiling").value_or("");
  default_walls_ = materials_.use(root_, "walls").value_or("");
}

std::string RoomReader::material(const TomlTable& table,
                                 std::string_view key,
                                 const std::string& otherwise) {
  if (table.has(key)) {
    return materials_.use(table, key).value_or("");
  }
  if (otherwise.empty() && !root_.has(key)) {
    table.error("no '" + std::string(key) + "' is stated, here or for the whole file; add, for " +
                "example: " + std::string(key) + " = \"concrete\"");
  }
  return otherwise;
}

void RoomReader::read_room(const TomlTable& table) {
  const bool single = &table == &root_;
  Stated stated;
  PlanRoom& room = stated.room;
  if (!single) {
    room.name = table.string("name").value_or("");
    if (!room.name.empty() && !is_object_name(room.name)) {
      table.error_at("name",
                     "'name' is '" + room.name + "'; write letters, digits, '-' and '_' only");
    }
    const bool twice = std::any_of(stated_.begin(), stated_.end(), [&](const Stated& other) {
      return other.room.name == room.name;
    });
    if (twice) {
      table.error_at("name", "a second room '" + room.name + "'; give each its own name");
    }
  }
  const auto height = table.number("height", kHeight);
  room.height = height.value_or(default_height_);
  if (!single && !table.has("height") && !root_.has("height")) {
    table.require({{"height", "height = 2.7"}});
  }
  room.floor = single ? default_floor_ : material(table, "floor", default_floor_);
  room.ceiling = single ? default_ceiling_ : material(table, "ceiling", default_ceiling_);
  if (!read_outline(table, room)) {
    for (std::size_t i = 0; i < kMaxOutlineCorners; ++i) {
      table.ask_for(wall_key(i));  // the number of walls is unknown
    }
    sound_ = false;
    return;
  }
  const bool all_stated = [&] {
    for (std::size_t i = 0; i < room.outline.size(); ++i) {
      if (!table.has(wall_key(i))) {
        return false;
      }
    }
    return true;
  }();
  const std::string walls =
      all_stated && !table.has("walls") ? std::string() : material(table, "walls", default_walls_);
  for (std::size_t i = 0; i < room.outline.size(); ++i) {
    stated.walls.push_back(materials_.use(table, wall_key(i)).value_or(walls));
  }
  if (sound_) {
    check_apart(table, room);
  }
  stated_.push_back(std::move(stated));
}

bool RoomReader::read_outline(const TomlTable& table, PlanRoom& room) {
  table.require({{"outline", kOutlineExample}});
  const auto pairs = table.pairs("outline", kOutlineExample);
  if (!pairs) {
    return false;
  }
  for (const TomlTable::Pair& pair : *pairs) {
    if (std::abs(pair.values[0]) > kFarthest || std::abs(pair.values[1]) > kFarthest) {
      table.error_at("outline", "'outline' has a corner further than 10 km away; write metres");
      return false;
    }
    room.outline.push_back(pair.values);
  }
  if (const auto mistake = outline_mistake(room.outline)) {
    table.error_at("outline", "'outline' " + *mistake);
    return false;
  }
  return true;
}

void RoomReader::check_apart(const TomlTable& table, const PlanRoom& room) {
  for (const Stated& other : stated_) {
    if (overlap(room, other.room)) {
      table.error_at("outline",
                     "the room lies in part over the room '" + other.room.name +
                         "'; rooms may share a wall, not floor");
      sound_ = false;
    }
  }
}

void RoomReader::read_slope(const TomlTable& table) {
  table.require({{"from", "from = [0, 0, 1.2]"},
                 {"to", "to = [0, 4, 1.2]"},
                 {"through", "through = [2, 0, 2.7]"}});
  const auto from = table.numbers<3>("from", "from = [0, 0, 1.2]");
  const auto to = table.numbers<3>("to", "to = [0, 4, 1.2]");
  const auto through = table.numbers<3>("through", "through = [2, 0, 2.7]");
  const auto name = table.string("room");
  if (!from || !to || !through) {
    sound_ = false;
    return;
  }
  const auto point = [](const std::array<double, 3>& p) { return Vec3d{p[0], p[1], p[2]}; };
  const Vec3d normal = cross(point(*to) - point(*from), point(*through) - point(*from));
  if (std::hypot(normal.x, normal.y) >= kSteepest * std::abs(normal.z)) {
    table.error_at("through",
                   "'from', 'to' and 'through' are no three points of a ceiling: they lie on one "
                   "line, or above one another");
    sound_ = false;
    return;
  }
  const PlanSlope slope{
      -normal.x / normal.z, -normal.y / normal.z, dot(normal, point(*from)) / normal.z};
  bool found = false;
  for (Stated& stated : stated_) {
    if (!name || stated.room.name == *name) {
      stated.room.slopes.push_back(slope);
      found = true;
    }
  }
  if (!found && sound_) {
    table.error_at("room", "there is no [[room]] '" + name.value_or("") + "'");
  }
}

bool RoomReader::check_ceilings() {
  for (const Stated& stated : stated_) {
    for (const FloorPoint& corner : stated.room.outline) {
      if (stated.room.ceiling_at(corner) < stated.room.level - kTouchingDistance) {
        root_.error_at("slope",
                       "the ceiling comes down below the floor at the corner " +
                           to_text(corner[0]) + ", " + to_text(corner[1]) +
                           "; correct the points of the slope, or end the outline where the "
                           "ceiling meets the floor");
        return false;
      }
    }
  }
  return true;
}

void RoomReader::add_walls_of(const Stated& stated) {
  const PlanRoom& room = stated.room;
  const std::size_t n = room.outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    PlanWall wall;
    wall.from = room.outline[i];
    wall.to = room.outline[(i + 1) % n];
    wall.faces_left = signed_area(room.outline) > 0.0;
    wall.name = name_in(room, wall_key(i));
    names_.insert(wall.name);
    wall.material = stated.walls[i];
    wall.top = upper_edge(room, wall.from, wall.to, room.height);
    add_wall(std::move(wall), plan_.walls);
  }
}

void RoomReader::read_partitions(const std::vector<PlanRoom>& rooms) {
  for (const TomlTable& table : root_.tables("partition")) {
    table.require({{"name", "name = \"partition\""},
                   {"from", "from = [3, 0]"},
                   {"to", "to = [3, 2.5]"},
                   {"material", "material = \"plasterboard\""}});
    PlanWall wall;
    wall.name = read_object_name(table, names_);
    wall.material = materials_.use(table, "material").value_or("");
    const auto from = table.numbers<2>("from", "from = [3, 0]");
    const auto to = table.numbers<2>("to", "to = [3, 2.5]");
    const auto height = table.number("height", kHeight);
    if (!from || !to) {
      continue;
    }
    wall.from = *from;
    wall.to = *to;
    if (wall.length() < kMinLength) {
      table.error_at("to", "the wall ends where it begins; correct 'from' or 'to'");
      continue;
    }
    const auto inside = [&](const PlanRoom& room) {
      return is_within(room.outline, *from, kTouchingDistance) &&
             is_within(room.outline, *to, kTouchingDistance) &&
             is_within(room.outline, between(*from, *to, 0.5), kTouchingDistance);
    };
    const auto room = std::find_if(rooms.begin(), rooms.end(), inside);
    if (rooms.empty()) {
      continue;
    }
    if (room == rooms.end()) {
      table.error_at("from", "the wall is not within one room; correct 'from' or 'to'");
      continue;
    }
    wall.top = upper_edge(*room, *from, *to, height ? room->level + *height : room->height);
    plan_.walls.push_back(std::move(wall));
  }
}

}  // namespace rayloc
