#include "daemon/live/live_map/map_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/live/live_map/millimetre.h"
#include "daemon/live/live_map/wall_openings.h"
#include "daemon/site/plan/floor_plan.h"
#include "engine/base/mat3.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

// In a scene with more faces than a browser draws smoothly, furniture is shown by its outline.
constexpr std::size_t kMaxFaces = 20'000;

Json flat(const Vec3d& point) { return {to_millimetre(point.x), to_millimetre(point.y)}; }

Json exact_point(const Vec3d& point) { return {point.x, point.y, point.z}; }

Json flat(const std::vector<Vec3d>& points) {
  Json list = Json::array();
  for (const Vec3d& point : points) {
    list.push_back(flat(point));
  }
  return list;
}

const char* name_of(draw::PartKind kind) {
  switch (kind) {
    case draw::PartKind::kFloor:
      return "floor";
    case draw::PartKind::kCeiling:
      return "ceiling";
    case draw::PartKind::kWall:
      return "wall";
    case draw::PartKind::kFurniture:
      break;
  }
  return "furniture";
}

Json shape(const char* kind, const draw::ScenePart& part, const char* form, Json points) {
  return {
      {"kind", kind}, {"name", part.name}, {"material", part.material}, {form, std::move(points)}};
}

std::vector<Vec3d> outline(const Bounds& bounds) {
  const Vec3d& low = bounds.lower;
  const Vec3d& high = bounds.upper;
  return {low, {high.x, low.y, low.z}, high, {low.x, high.y, low.z}};
}

// Adds a cut; walls have another kind than objects in front of them that are as high.
void add_cut(const draw::ScenePart& part, const draw::MeshSection& section, Json& shapes) {
  const char* const kind = part.kind == draw::PartKind::kWall ? "cut" : "cut furniture";
  for (const auto& loop : section.loops) {
    shapes.push_back(shape(kind, part, "area", flat(loop)));
  }
  for (const auto& line : section.lines) {
    shapes.push_back(shape(kind, part, "line", flat(line)));
  }
}

// Shapes in the order in which they are painted.
Json plan_json(const Scene& scene) {
  const std::vector<draw::ScenePart> parts = draw::scene_parts(scene);
  const draw::FloorPlan plan = draw::floor_plan(scene, parts);
  Json shapes = Json::array();
  if (plan.below.size() <= kMaxFaces) {
    for (const draw::Face& face : plan.below) {
      const draw::ScenePart& part = parts[face.object];
      shapes.push_back(shape(name_of(part.kind), part, "area", flat(face.corners)));
    }
  } else {
    for (const draw::ScenePart& part : parts) {
      if (part.kind == draw::PartKind::kFloor || part.kind == draw::PartKind::kFurniture) {
        shapes.push_back(shape(name_of(part.kind), part, "area", flat(outline(part.bounds))));
      }
    }
  }
  const std::vector<WallOpening> openings = wall_openings(parts, plan);
  for (const draw::FloorPlan::Cut& cut : plan.cuts) {
    const bool is_opening =
        std::any_of(openings.begin(), openings.end(), [&](const WallOpening& one) {
          return one.object == cut.object;
        });
    if (!is_opening) {
      add_cut(parts[cut.object], cut.section, shapes);
    }
  }
  for (const WallOpening& one : openings) {
    shapes.push_back(shape(one.is_door ? "door" : "window",
                           parts[one.object],
                           "area",
                           flat({one.corners.begin(), one.corners.end()})));
  }
  for (const std::uint32_t object : plan.overhead) {
    shapes.push_back(shape("overhead", parts[object], "area", flat(outline(parts[object].bounds))));
  }
  return shapes;
}

Json access_points_json(const RoomModel& room) {
  Json list = Json::array();
  for (const RoomAccessPoint& access_point : room.access_points) {
    const Vec3d facing = rotation(access_point.array.pose.orientation) * Vec3d{1.0, 0.0, 0.0};
    Json antennas = Json::array();
    for (std::size_t i = 0; i < access_point.array.element_offset.size(); ++i) {
      antennas.push_back(exact_point(element_position(access_point.array, i)));
    }
    list.push_back({{"id", access_point.id},
                    {"position", exact_point(access_point.array.pose.position)},
                    {"facing", exact_point(facing)},
                    {"antennas", std::move(antennas)},
                    {"cores", access_point.rx_chains}});
  }
  return list;
}

Json fixed_transmitters_json(const Site& site, bool addresses) {
  Json list = Json::array();
  for (const SiteTransmitter& one : site.transmitters) {
    if (one.role == TransmitterRole::kFixed && one.position) {
      list.push_back({{"mac", addresses ? to_string(one.mac) : ""},
                      {"name", one.name},
                      {"position", exact_point(*one.position)}});
    }
  }
  return list;
}

Json zones_json(const Site& site) {
  Json list = Json::array();
  for (const SiteZone& zone : site.zones) {
    list.push_back({{"name", zone.name}, {"polygon", zone.polygon}});
  }
  return list;
}

Json unavailable(const std::string& reason) { return {{"available", false}, {"reason", reason}}; }

// Names and reasons come from files that may contain any bytes.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json calibration_json(const Site& site, const RoomModel& room) {
  if (!site.calibration_file) {
    return unavailable("the site is not calibrated (rayloc calibrate)");
  }
  const std::filesystem::path file = site.calibration_file->parent_path() / "report.json";
  std::ifstream in(file);
  const Json report = in ? Json::parse(in, nullptr, false) : Json();
  if (!report.is_object()) {
    return unavailable("there is no report beside the calibration");
  }
  if (report.value("calibration_id", "") != room.calibration_id) {
    return unavailable("the report beside the calibration is of another one");
  }
  Json selected = {{"available", true}};
  for (const char* key :
       {"method", "calibration_id", "points", "heldout_is", "heldout", "moved", "fits"}) {
    if (report.contains(key)) {
      selected[key] = report[key];
    }
  }
  const Json::json_pointer expectation("/verdict/expectation");
  if (report.contains(expectation)) {
    selected["expectation"] = report.at(expectation);
  }
  return selected;
}

}  // namespace

std::string map_geometry_json(const Site& site,
                              const RoomModel& room,
                              const std::vector<std::string>& methods,
                              bool addresses) {
  Json map = {
      {"site", site.name},
      {"crs", "local"},
      {"scene_hash", room.scene_hash},
      {"calibration_id", room.calibration_id},
      {"methods", methods},
      {"bounds", {{"min", exact_point(room.bounds_min)}, {"max", exact_point(room.bounds_max)}}},
      {"plan", plan_json(*room.scene)},
      {"access_points", access_points_json(room)},
      {"fixed_transmitters", fixed_transmitters_json(site, addresses)},
      {"zones", zones_json(site)}};
  if (site.georeference) {
    map["georeference"] = {
        {"latitude", site.georeference->latitude},
        {"longitude", site.georeference->longitude},
        {"altitude_m", site.georeference->altitude},
        {"rotation_deg", site.georeference->rotation * 180.0 / std::numbers::pi}};
  }
  return text_of(map);
}

std::string map_plan_json(const Scene& scene) { return text_of(plan_json(scene)); }

std::string map_without_room_json(const Site& site, const std::string& reason) {
  Json map = {{"site", site.name}};
  map.update(unavailable(reason));
  return text_of(map);
}

std::string map_calibration_json(const Site& site, const RoomModel& room) {
  return text_of(calibration_json(site, room));
}

std::string map_without_calibration_json(const std::string& reason) {
  return text_of(unavailable(reason));
}

}  // namespace rayloc
