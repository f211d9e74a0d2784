#include <algorithm>
#include <cmath>

#include "daemon/site/model/site_tables.h"
#include "engine/base/outline.h"

namespace rayloc {
namespace {

// A zone may extend this far out of the room: to the far side of a wall.
constexpr double kReach = 0.5;  // [m]

using Point = FloorPoint;

constexpr std::size_t kMaxZonePoints = 256;

std::vector<Point> read_polygon(const SiteTable& zone) {
  const auto polygon = zone.pairs("polygon");
  if (!polygon) {
    return {};
  }
  if (polygon->size() < 3 || polygon->size() > kMaxZonePoints) {
    zone.error_at("polygon",
                  "'polygon' has " + std::to_string(polygon->size()) + " points; write 3 to " +
                      std::to_string(kMaxZonePoints) +
                      " corners: " + std::string(site_key("zone", "polygon").example));
    return {};
  }
  std::vector<Point> points;
  points.reserve(polygon->size());
  for (const TomlTable::Pair& corner : *polygon) {
    points.push_back(corner.values);
  }
  if (const std::size_t edge = first_crossing(points); edge < points.size()) {
    zone.error_at("polygon",
                  "'polygon' crosses itself at its edge " + std::to_string(edge + 1) +
                      "; list the corners in the order of the outline");
    return {};
  }
  if (!(std::abs(signed_area(points)) > 1e-6)) {
    zone.error_at("polygon", "'polygon' encloses no area; its corners lie on one line");
    return {};
  }
  return points;
}

void read_seconds(const SiteTable& zone, std::string_view key, Duration& out) {
  if (const auto seconds = zone.number(key)) {
    out = from_seconds(*seconds);
  }
}

void read_hysteresis(const SiteTable& table, SiteZone& zone) {
  zone.enter_probability = table.number("enter_probability").value_or(zone.enter_probability);
  zone.leave_probability = table.number("leave_probability").value_or(zone.leave_probability);
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

void read_zones(const SiteTable& root, Site& site) {
  for (const SiteTable& table : root.tables("zone")) {
    SiteZone zone;
    zone.place = table.toml().place();
    zone.name = read_topic_name(table.toml()).value_or("");
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
