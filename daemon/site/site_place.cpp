#include <cmath>
#include <numbers>

#include "daemon/site/site_tables.h"

namespace rayloc {
namespace {

constexpr double kFarthest = 10'000.0;  // [m], of any coordinate: beyond it is a slip of the pen
// An access point or transmitter may stand this far outside the stated bounds: behind a panel, on
// the far side of a wall.
constexpr double kBoundsSlack = 0.5;  // [m]

using Point = std::array<double, 2>;

double cross(const Point& origin, const Point& a, const Point& b) {
  return (a[0] - origin[0]) * (b[1] - origin[1]) - (a[1] - origin[1]) * (b[0] - origin[0]);
}

bool within_box(const Point& a, const Point& b, const Point& p) {
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
         std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
}

// Whether the segments a-b and c-d have a point in common.
bool segments_touch(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double d1 = cross(c, d, a);
  const double d2 = cross(c, d, b);
  const double d3 = cross(a, b, c);
  const double d4 = cross(a, b, d);
  if (((d1 > 0) != (d2 > 0)) && ((d3 > 0) != (d4 > 0)) && d1 != 0 && d2 != 0 && d3 != 0 &&
      d4 != 0) {
    return true;
  }
  return (d1 == 0 && within_box(c, d, a)) || (d2 == 0 && within_box(c, d, b)) ||
         (d3 == 0 && within_box(a, b, c)) || (d4 == 0 && within_box(a, b, d));
}

// The first edge that meets one that is not its neighbour; the number of points when there is none.
// A zone is drawn by hand: few points, so that comparing all pairs costs nothing.
std::size_t first_crossing(const std::vector<TomlTable::Pair>& polygon) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const bool neighbours = i == 0 && j + 1 == n;
      if (!neighbours && segments_touch(polygon[i].values,
                                        polygon[i + 1].values,
                                        polygon[j].values,
                                        polygon[(j + 1) % n].values)) {
        return j;
      }
    }
  }
  return n;
}

constexpr std::size_t kMaxZonePoints = 256;
constexpr std::string_view kPolygonExample = "polygon = [[0, 0], [2, 0], [2, 1]]";

std::vector<Point> read_polygon(const TomlTable& zone) {
  const auto polygon = zone.pairs("polygon", kPolygonExample);
  if (!polygon) {
    return {};
  }
  if (polygon->size() < 3 || polygon->size() > kMaxZonePoints) {
    zone.error_at("polygon",
                  "'polygon' has " + std::to_string(polygon->size()) + " points; write 3 to " +
                      std::to_string(kMaxZonePoints) + " corners: " + std::string(kPolygonExample));
    return {};
  }
  std::vector<Point> points;
  double area = 0.0;
  for (std::size_t i = 0; i < polygon->size(); ++i) {
    const Point& point = (*polygon)[i].values;
    points.push_back(point);
    area += 0.5 * cross((*polygon)[0].values, point, (*polygon)[(i + 1) % polygon->size()].values);
  }
  if (const std::size_t edge = first_crossing(*polygon); edge < polygon->size()) {
    zone.error_at("polygon",
                  "'polygon' crosses itself at its edge " + std::to_string(edge + 1) +
                      "; list the corners in the order of the outline");
    return {};
  }
  if (!(std::abs(area) > 1e-6)) {
    zone.error_at("polygon", "'polygon' encloses no area; its corners lie on one line");
    return {};
  }
  return points;
}

}  // namespace

std::optional<Vec3d> read_position(const TomlTable& table, const Site& site) {
  const auto values = table.numbers<3>("position", "position = [1.2, -0.4, 2.1]");
  if (!values) {
    return std::nullopt;
  }
  const Vec3d position{(*values)[0], (*values)[1], (*values)[2]};
  const std::array<double, 3> low{site.bounds_min.x, site.bounds_min.y, site.bounds_min.z};
  const std::array<double, 3> high{site.bounds_max.x, site.bounds_max.y, site.bounds_max.z};
  constexpr std::string_view kAxes = "xyz";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double min = site.has_bounds ? low.at(axis) - kBoundsSlack : -kFarthest;
    const double max = site.has_bounds ? high.at(axis) + kBoundsSlack : kFarthest;
    const double value = values->at(axis);
    if (value < min || value > max) {
      table.error_at(
          "position",
          std::string("'position' has ") + kAxes[axis] + " = " + to_text(value) + " m, outside " +
              (site.has_bounds ? "[bounds] " + std::string(1, kAxes[axis]) + " = [" +
                                     to_text(low.at(axis)) + ", " + to_text(high.at(axis)) + "]"
                               : "10 km") +
              "; write metres in the coordinates of the room");
      return std::nullopt;
    }
  }
  return position;
}

void read_bounds(const TomlTable& bounds, Site& site) {
  bounds.require({{"x", "x = [-2.5, 2.5]"}, {"y", "y = [-2, 2]"}, {"z", "z = [0, 2.7]"}});
  const auto axis = [&bounds](std::string_view key, double& min, double& max) {
    const auto values = bounds.numbers<2>(key, std::string(key) + " = [0, 2.7]");
    if (!values) {
      return false;
    }
    min = (*values)[0];
    max = (*values)[1];
    if (!(min < max) || std::abs(min) > kFarthest || std::abs(max) > kFarthest) {
      bounds.error_at(key,
                      "'" + std::string(key) + "' is [" + to_text(min) + ", " + to_text(max) +
                          "]; write [smallest, largest] in metres");
      return false;
    }
    return true;
  };
  const bool x = axis("x", site.bounds_min.x, site.bounds_max.x);
  const bool y = axis("y", site.bounds_min.y, site.bounds_max.y);
  const bool z = axis("z", site.bounds_min.z, site.bounds_max.z);
  site.has_bounds = x && y && z;
}

void read_person(const TomlTable& person, Site& site) {
  SitePerson& out = site.person.emplace();
  out.radius = person.number("radius_m", {0.05, 0.5, "m"}).value_or(out.radius);
  out.height = person.number("height_m", {0.3, 2.5, "m"}).value_or(out.height);
  out.area_centre = person.numbers<2>("area_centre", "area_centre = [0, 0.3]");
  out.area_radius = person.number("area_radius_m", {0.01, kFarthest, "m"});
  if (person.has("area_centre") != person.has("area_radius_m")) {
    person.error("[person] states one of 'area_centre' and 'area_radius_m'; write both or none");
  }
}

void read_materials(const TomlTable& root, Site& site) {
  for (const auto& [name, table] : root.named_tables("materials")) {
    MaterialOverride& out = site.materials[name];
    out.relative_permittivity = table.number("relative_permittivity", {1.0, 1e4});
    out.conductivity = table.number("conductivity", {0.0, 1e9, "S/m"});
    out.thickness = table.number("thickness_m", {1e-5, 10.0, "m"});
  }
}

void read_georeference(const TomlTable& georeference, Site& site) {
  georeference.require({{"latitude", "latitude = 49.87"}, {"longitude", "longitude = 8.65"}});
  Georeference& out = site.georeference.emplace();
  out.latitude = georeference.number("latitude", {-90.0, 90.0, "degrees"}).value_or(0.0);
  out.longitude = georeference.number("longitude", {-180.0, 180.0, "degrees"}).value_or(0.0);
  out.altitude = georeference.number("altitude_m", {-1000.0, kFarthest, "m"}).value_or(0.0);
  out.rotation = georeference.number("rotation_deg", {-360.0, 360.0, "degrees"}).value_or(0.0) *
                 std::numbers::pi / 180.0;
}

void read_zones(const TomlTable& root, Site& site) {
  for (const TomlTable& table : root.tables("zone")) {
    table.require({{"name", "name = \"desk\""}, {"polygon", kPolygonExample}});
    SiteZone zone;
    zone.name = read_topic_name(table).value_or("");
    zone.polygon = read_polygon(table);
    for (const SiteZone& other : site.zones) {
      if (!zone.name.empty() && other.name == zone.name) {
        table.error_at("name", "a second zone '" + zone.name + "'; give each its own name");
      }
    }
    site.zones.push_back(std::move(zone));
  }
}

void read_targets(const TomlTable& targets, Site& site) {
  constexpr std::array<std::string_view, 2> kUnlisted = {"track", "ignore"};
  site.targets.track_unlisted = targets.choice("unlisted", kUnlisted).value_or("track") == "track";
  site.targets.height =
      targets.number("height_m", {-kFarthest, kFarthest, "m"}).value_or(site.targets.height);
}

}  // namespace rayloc
