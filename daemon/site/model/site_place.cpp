#include <cmath>
#include <numbers>

#include "daemon/site/model/site_tables.h"

namespace rayloc {
namespace {

// An access point or transmitter may be this far outside the stated bounds: behind a panel, on the
// far side of a wall.
constexpr double kBoundsSlack = 0.5;  // [m]

}  // namespace

std::optional<Vec3d> read_position(const SiteTable& table, const Site& site) {
  const auto values = table.numbers<3>("position");
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

void read_bounds(const SiteTable& bounds, Site& site) {
  const auto axis = [&bounds](std::string_view key, double& min, double& max) {
    const auto values = bounds.numbers<2>(key);
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

void read_person(const SiteTable& person, Site& site) {
  SitePerson& out = site.person.emplace();
  out.radius = person.number("radius_m").value_or(out.radius);
  out.height = person.number("height_m").value_or(out.height);
  out.area_centre = person.numbers<2>("area_centre");
  out.area_radius = person.number("area_radius_m");
}

void read_materials(const SiteTable& root, Site& site) {
  for (const auto& [name, table] : root.named_tables("materials")) {
    MaterialOverride& out = site.materials[name];
    out.relative_permittivity = table.number("relative_permittivity");
    out.conductivity = table.number("conductivity");
    out.thickness = table.number("thickness_m");
    out.scattering_coefficient = table.number("scattering_coefficient");
    out.xpd_coefficient = table.number("xpd_coefficient");
  }
}

void read_georeference(const SiteTable& georeference, Site& site) {
  Georeference& out = site.georeference.emplace();
  out.latitude = georeference.number("latitude").value_or(0.0);
  out.longitude = georeference.number("longitude").value_or(0.0);
  out.altitude = georeference.number("altitude_m").value_or(0.0);
  out.rotation = georeference.number("rotation_deg").value_or(0.0) * std::numbers::pi / 180.0;
}

void read_targets(const SiteTable& targets, Site& site) {
  site.targets.track_unlisted = targets.choice("unlisted").value_or("track") == "track";
  site.targets.height = targets.number("height_m").value_or(site.targets.height);
  site.targets.height_sigma = targets.number("height_sigma_m").value_or(site.targets.height_sigma);
}

}  // namespace rayloc
