#include <algorithm>
#include <cmath>

#include "daemon/site/site_tables.h"

namespace rayloc {
namespace {

// A zone may reach this far out of the room: to the far side of a wall.
constexpr double kReach = 0.5;  // [m]

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

// A number of seconds; at most a day.
void read_seconds(const TomlTable& zone, std::string_view key, Duration& out) {
  constexpr double kLongest = 86'400.0;
  if (const auto seconds = zone.number(key, {0.0, kLongest, "s"})) {
    out = from_seconds(*seconds);
  }
}

void read_hysteresis(const TomlTable& table, SiteZone& zone) {
  zone.enter_probability =
      table.number("enter_probability", {0.01, 0.99}).value_or(zone.enter_probability);
  zone.leave_probability =
      table.number("leave_probability", {0.0, 0.98}).value_or(zone.leave_probability);
  if (!(zone.leave_probability < zone.enter_probability)) {
    const bool is_leave = table.has("leave_probability");
    table.error_at(is_leave ? "leave_probability" : "enter_probability",
                   "'leave_probability' is " + to_text(zone.leave_probability) +
                       ", not below 'enter_probability' = " + to_text(zone.enter_probability) +
                       "; a target at the edge would come and go with every estimate");
  }
  read_seconds(table, "enter_after_s", zone.enter_after);
  read_seconds(table, "leave_after_s", zone.leave_after);
  read_seconds(table, "dwell_after_s", zone.dwell_after);
}

}  // namespace

void read_zones(const TomlTable& root, Site& site) {
  for (const TomlTable& table : root.tables("zone")) {
    table.require({{"name", "name = \"desk\""}, {"polygon", kPolygonExample}});
    SiteZone zone;
    zone.place = table.place();
    zone.name = read_topic_name(table).value_or("");
    zone.polygon = read_polygon(table);
    read_hysteresis(table, zone);
    for (const SiteZone& other : site.zones) {
      if (!zone.name.empty() && other.name == zone.name) {
        table.error_at("name", "a second zone '" + zone.name + "'; give each its own name");
      }
    }
    site.zones.push_back(std::move(zone));
  }
}

std::vector<std::string> zone_warnings(const Site& site, const Vec3d& lower, const Vec3d& upper) {
  std::vector<std::string> warnings;
  for (const SiteZone& zone : site.zones) {
    const auto outside =
        std::find_if(zone.polygon.begin(), zone.polygon.end(), [&](const Point& p) {
          return p[0] < lower.x - kReach || p[0] > upper.x + kReach || p[1] < lower.y - kReach ||
                 p[1] > upper.y + kReach;
        });
    if (outside != zone.polygon.end()) {
      warnings.push_back(zone.place + "warning: zone '" + zone.name + "' has a corner at " +
                         to_text((*outside)[0]) + ", " + to_text((*outside)[1]) +
                         ", outside of the room: x from " + to_text(lower.x) + " to " +
                         to_text(upper.x) + ", y from " + to_text(lower.y) + " to " +
                         to_text(upper.y));
    }
  }
  return warnings;
}

}  // namespace rayloc
