#include "daemon/site/scene/room_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "daemon/site/model/site_tables.h"
#include "daemon/site/scene/plan_materials.h"
#include "daemon/site/scene/read_rooms.h"

namespace rayloc {
namespace {

constexpr double kMinSize = 1e-3;         // [m]; smaller ones are typing errors
constexpr double kLargestRoom = 1'000.0;  // [m]
constexpr std::array<std::string_view, 4> kWalls = {"west", "east", "south", "north"};

// Rounded to the millimetre.
std::string metres(double value) { return to_text(std::round(value * 1e3) / 1e3); }

std::string span_text(double low, double high) {
  return "[" + metres(low) + ", " + metres(high) + "]";
}

PlanRoom room_within(const Vec3d& lower, const Vec3d& upper) {
  PlanRoom room;
  room.outline = {{lower.x, lower.y}, {upper.x, lower.y}, {upper.x, upper.y}, {lower.x, upper.y}};
  room.level = lower.z;
  room.height = upper.z;
  return room;
}

class PlanReader {
 public:
  explicit PlanReader(const TomlTable& root)
      : root_(root), carrier_known_(read_plan_carrier()), materials_(root, carrier_hz()) {}

  RoomPlan read() {
    RoomReader rooms(root_, materials_, names_, plan_);
    if (has_outlines(root_)) {
      root_.require({{"name", "name = \"office\""}});
      plan_.name = read_topic_name(root_).value_or("");
      has_size_ = rooms.read_rooms();
      rooms.read_partitions(plan_.rooms);
    } else {
      root_.require({{"name", "name = \"office\""},
                     {"size", "size = [5.2, 3.4, 2.7]"},
                     {"floor", "floor = \"concrete\""},
                     {"ceiling", "ceiling = \"ceiling_board\""}});
      plan_.name = read_topic_name(root_).value_or("");
      read_size();
      read_sides();
      rooms.read_partitions(has_size_ ? std::vector{room_within(plan_.lower, plan_.upper)}
                                      : std::vector<PlanRoom>{});
    }
    for (const TomlTable& table : root_.tables("opening")) {
      read_opening(table);
    }
    for (const TomlTable& table : root_.tables("box")) {
      read_box(table);
    }
    plan_.materials = materials_.finish();
    read_access_points_of_plan();
    return std::move(plan_);
  }

 private:
  bool read_plan_carrier() {
    if (const std::optional<TomlTable> table = root_.table("carrier")) {
      read_carrier({*table, "carrier"}, plan_.carrier);
      return plan_.carrier.grid.centre_hz > 0.0;
    }
    plan_.carrier = usual_carrier();
    return true;
  }
  // With an invalid carrier, materials are checked at a frequency of the band.
  double carrier_hz() const { return carrier_known_ ? plan_.carrier.grid.centre_hz : 5.19e9; }

  void read_size() {
    const auto size = root_.numbers<3>("size", "size = [5.2, 3.4, 2.7]");
    const auto corner = root_.numbers<3>("corner", "corner = [0, 0, 0]");
    const std::array<double, 3> lower = corner.value_or(std::array<double, 3>{});
    for (const double value : lower) {
      if (std::abs(value) > kFarthest) {
        root_.error_at("corner", "'corner' is further than 10 km away; write metres");
        return;
      }
    }
    if (!size) {
      return;
    }
    for (const double value : *size) {
      if (value < 0.1 || value > kLargestRoom) {
        root_.error_at("size",
                       "'size' has " + to_text(value) +
                           " m; write the inside along x, y and z in metres, 0.1 to 1000 each");
        return;
      }
    }
    plan_.lower = {lower[0], lower[1], lower[2]};
    plan_.upper = plan_.lower + Vec3d{(*size)[0], (*size)[1], (*size)[2]};
    has_size_ = true;
  }

  void read_sides() {
    const std::optional<std::string> walls = materials_.use(root_, "walls");
    bool stated_alone = true;
    for (std::size_t i = 0; i < kRoomSides.size(); ++i) {
      const bool is_wall = i >= static_cast<std::size_t>(RoomSide::kWest);
      stated_alone = stated_alone && (!is_wall || root_.has(kRoomSides.at(i)));
      plan_.side_material.at(i) =
          materials_.use(root_, kRoomSides.at(i)).value_or(is_wall ? walls.value_or("") : "");
      names_.emplace(kRoomSides.at(i));
    }
    if (!root_.has("walls") && !stated_alone) {
      root_.require({{"walls", "walls = \"plasterboard\""}});
    }
  }

  void read_opening(const TomlTable& table) {
    table.require({{"name", "name = \"door\""},
                   {"wall", plan_.rooms.empty() ? "wall = \"east\"" : "wall = \"wall_1\""},
                   {"centre", "centre = [1.0, 1.0]"},
                   {"size", "size = [0.9, 2.0]"}});
    PlanOpening opening;
    opening.name = read_object_name(table, names_);
    opening.material = materials_.use(table, "material").value_or("");
    const auto centre = table.numbers<2>("centre", "centre = [1.0, 1.0]");
    const auto size = table.numbers<2>("size", "size = [0.9, 2.0]");
    if (!has_size_) {
      table.ask_for("wall");  // the key may be valid: the size is unknown
      return;
    }
    std::vector<std::string_view> names;
    if (plan_.rooms.empty()) {
      names.assign(kWalls.begin(), kWalls.end());
    }
    const std::size_t sides = names.size();
    for (const PlanWall& wall : plan_.walls) {
      names.push_back(wall.name);
    }
    const std::optional<std::string> wall = table.choice("wall", names);
    if (!wall || !centre || !size) {
      return;
    }
    const auto number =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), *wall) - names.begin());
    if (number < sides) {
      opening.wall = static_cast<RoomSide>(static_cast<std::size_t>(RoomSide::kWest) + number);
      add_to_side(table, *centre, *size, std::move(opening));
    } else {
      add_to_wall(table, *centre, *size, std::move(opening), plan_.walls.at(number - sides));
    }
  }

  void add_to_side(const TomlTable& table,
                   const FloorPoint& centre,
                   const FloorPoint& size,
                   PlanOpening opening) {
    const bool along_y = opening.wall == RoomSide::kWest || opening.wall == RoomSide::kEast;
    const Face face{{along_y ? plan_.lower.y : plan_.lower.x, plan_.lower.z},
                    {along_y ? plan_.upper.y : plan_.upper.x, plan_.upper.z},
                    along_y ? "in y" : "in x"};
    if (!place_opening(table, centre, size, face, opening)) {
      return;
    }
    for (const PlanOpening& other : plan_.openings) {
      if (other.wall == opening.wall && overlaps(table, opening, other)) {
        return;
      }
    }
    plan_.openings.push_back(std::move(opening));
  }

  void add_to_wall(const TomlTable& table,
                   const FloorPoint& centre,
                   const FloorPoint& size,
                   PlanHole opening,
                   PlanWall& wall) const {
    double highest = plan_.lower.z;
    for (const FloorPoint& bend : wall.top) {
      highest = std::max(highest, bend[1]);
    }
    const Face face{{0.0, plan_.lower.z}, {wall.length(), highest}, "along it"};
    if (!place_opening(table, centre, size, face, opening)) {
      return;
    }
    const double ceiling = lowest_between(wall.top, opening.lower[0], opening.upper[0]);
    if (opening.upper[1] > ceiling + kTouchingDistance) {
      table.error_at("centre",
                     "the opening reaches up to " + metres(opening.upper[1]) +
                         " m, its wall there to " + metres(ceiling) +
                         " m; correct 'centre' or 'size'");
      return;
    }
    for (const PlanHole& other : wall.holes) {
      if (overlaps(table, opening, other)) {
        return;
      }
    }
    wall.holes.push_back(std::move(opening));
  }

  // The area of a wall that may contain openings.
  struct Face {
    FloorPoint low;  // along it, height [m]
    FloorPoint high;
    std::string_view axis;  // "in y"
  };

  // Places the opening; false, and an error, if it is not within its wall.
  static bool place_opening(const TomlTable& table,
                            const FloorPoint& centre,
                            const FloorPoint& size,
                            const Face& face,
                            PlanHole& opening) {
    for (std::size_t i = 0; i < 2; ++i) {
      if (size.at(i) < kMinSize) {
        table.error_at("size",
                       "'size' has " + to_text(size.at(i)) + " m; write width and height, in m");
        return false;
      }
      opening.lower.at(i) = centre.at(i) - 0.5 * size.at(i);
      opening.upper.at(i) = centre.at(i) + 0.5 * size.at(i);
      if (opening.lower.at(i) < face.low.at(i) - kTouchingDistance ||
          opening.upper.at(i) > face.high.at(i) + kTouchingDistance) {
        table.error_at("centre",
                       "the opening is at " + span_text(opening.lower.at(i), opening.upper.at(i)) +
                           " m " + std::string(i == 0 ? face.axis : "in height") +
                           ", its wall at " + span_text(face.low.at(i), face.high.at(i)) +
                           " m; correct 'centre' or 'size'");
        return false;
      }
      opening.lower.at(i) = std::max(opening.lower.at(i), face.low.at(i));
      opening.upper.at(i) = std::min(opening.upper.at(i), face.high.at(i));
    }
    return true;
  }

  // Notes an error if two openings of a wall overlap.
  static bool overlaps(const TomlTable& table, const PlanHole& opening, const PlanHole& other) {
    for (std::size_t i = 0; i < 2; ++i) {
      if (std::min(opening.upper.at(i), other.upper.at(i)) -
              std::max(opening.lower.at(i), other.lower.at(i)) <=
          kTouchingDistance) {
        return false;
      }
    }
    const bool is_stretch = std::isinf(other.lower[1]);
    table.error_at("centre",
                   is_stretch ? "there the wall is that of another room, '" + other.name +
                                    "'; name that one in 'wall'"
                              : "the opening overlaps the opening '" + other.name + "'");
    return true;
  }

  void read_box(const TomlTable& table) {
    table.require({{"name", "name = \"table\""},
                   {"material", "material = \"wood\""},
                   {"centre", "centre = [2.0, 1.5, 0.73]"},
                   {"size", "size = [1.8, 0.9, 0.05]"}});
    PlanBox box;
    box.name = read_object_name(table, names_);
    box.material = materials_.use(table, "material").value_or("");
    const auto centre = table.numbers<3>("centre", "centre = [2.0, 1.5, 0.73]");
    const auto size = table.numbers<3>("size", "size = [1.8, 0.9, 0.05]");
    box.yaw = table.number("yaw_deg", {-360.0, 360.0, "degrees"}).value_or(0.0) * std::numbers::pi /
              180.0;
    if (!centre || !size) {
      return;
    }
    const auto flat = std::count(size->begin(), size->end(), 0.0);
    const bool thin = std::any_of(size->begin(), size->end(), [](double value) {
      return value != 0.0 && (value < kMinSize || value > kLargestRoom);
    });
    if (flat > 1 || thin) {
      table.error_at("size",
                     "'size' is the length along the box's x, y and z: write 0.001 to 1000 m; one "
                     "of the three may be 0, for a sheet");
      return;
    }
    box.centre = {(*centre)[0], (*centre)[1], (*centre)[2]};
    box.size = {(*size)[0], (*size)[1], (*size)[2]};
    if (check_inside(table, box)) {
      plan_.boxes.push_back(std::move(box));
    }
  }

  // True if the box is in the room; else notes by how much it exceeds the room.
  bool check_inside(const TomlTable& table, const PlanBox& box) const {
    if (!has_size_) {
      return false;
    }
    if (!plan_.rooms.empty()) {
      return check_in_rooms(table, box);
    }
    const double c = std::abs(std::cos(box.yaw));
    const double s = std::abs(std::sin(box.yaw));
    const Vec3d half{0.5 * (c * box.size.x + s * box.size.y),
                     0.5 * (s * box.size.x + c * box.size.y),
                     0.5 * box.size.z};
    const Vec3d below = plan_.lower - (box.centre - half);
    const Vec3d above = box.centre + half - plan_.upper;
    const std::array<double, kRoomSides.size()> beyond{
        below.z, above.z, below.x, above.x, below.y, above.y};  // in the order of RoomSide
    for (std::size_t i = 0; i < beyond.size(); ++i) {
      if (beyond.at(i) > kTouchingDistance) {
        table.error_at("centre",
                       "the box reaches " + metres(beyond.at(i)) + " m beyond the " +
                           std::string(kRoomSides.at(i)) + "; correct 'centre' or 'size'");
        return false;
      }
    }
    return true;
  }

  // True if the box is in one of the rooms with an outline, and below its ceiling.
  bool check_in_rooms(const TomlTable& table, const PlanBox& box) const {
    std::vector<FloorPoint> footprint;
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      footprint.push_back(
          {box.centre.x + x * std::cos(box.yaw) * box.size.x - y * std::sin(box.yaw) * box.size.y,
           box.centre.y + x * std::sin(box.yaw) * box.size.x + y * std::cos(box.yaw) * box.size.y});
    }
    for (const PlanRoom& room : plan_.rooms) {
      const bool corners_inside =
          std::all_of(footprint.begin(), footprint.end(), [&](const FloorPoint& corner) {
            return is_within(room.outline, corner, kTouchingDistance);
          });
      // A corner of the room within the box: the room extends around it.
      const bool goes_round =
          std::any_of(room.outline.begin(), room.outline.end(), [&](const FloorPoint& corner) {
            return is_within(footprint, corner, 0.0) && !is_on_edge(footprint, corner);
          });
      if (!corners_inside || goes_round) {
        continue;
      }
      double ceiling = room.height;
      for (const FloorPoint& corner : footprint) {
        ceiling = std::min(ceiling, room.ceiling_at(corner));
      }
      const double above = box.centre.z + 0.5 * box.size.z - ceiling;
      const double below = room.level - (box.centre.z - 0.5 * box.size.z);
      if (above <= kTouchingDistance && below <= kTouchingDistance) {
        return true;
      }
      table.error_at("centre",
                     "the box reaches " + metres(std::max(above, below)) + " m beyond the " +
                         name_in(room, above > below ? "ceiling" : "floor") +
                         "; correct 'centre' or 'size'");
      return false;
    }
    table.error_at("centre", "the box is not within one room; correct 'centre' or 'size'");
    return false;
  }

  static bool is_on_edge(const std::vector<FloorPoint>& outline, const FloorPoint& p) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (distance_from_edge(outline[i], outline[(i + 1) % outline.size()], p).across <=
          kTouchingDistance) {
        return true;
      }
    }
    return false;
  }

  void read_access_points_of_plan() {
    Site site;
    site.bounds_min = plan_.lower;
    site.bounds_max = plan_.upper;
    site.has_bounds = has_size_;
    std::vector<SiteTable> tables;
    for (const TomlTable& table : root_.tables("access_point")) {
      tables.emplace_back(table, "access_point");
    }
    read_access_points(tables, site);
    plan_.access_points = std::move(site.access_points);
  }

  const TomlTable& root_;
  RoomPlan plan_;
  bool carrier_known_;
  PlanMaterials materials_;
  std::set<std::string> names_;
  bool has_size_ = false;
};

Expected<RoomPlan> read_document(TomlDocument& document) {
  const TomlTable root = document.root();
  RoomPlan plan = PlanReader(root).read();
  RAYLOC_TRY(document.finish());
  return plan;
}

}  // namespace

Carrier usual_carrier() {
  Carrier carrier{36, 40, {5.19e9, 312'500.0, {}}};
  for (int tone = -58; tone <= 58; ++tone) {
    if (std::abs(tone) >= 2) {
      carrier.grid.tone_index.push_back(static_cast<std::int16_t>(tone));
    }
  }
  return carrier;
}

Expected<RoomPlan> parse_room_plan(std::string_view text, const std::filesystem::path& file) {
  const auto document = TomlDocument::parse(text, file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

Expected<RoomPlan> load_room_plan(const std::filesystem::path& file) {
  const auto document = TomlDocument::read(file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

}  // namespace rayloc
