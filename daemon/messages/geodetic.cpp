#include "daemon/messages/geodetic.h"
#include "engine/base/constants.h"

#include <cmath>

namespace rayloc {
namespace {

// WGS 84: semi-major axis [m] and flattening.
constexpr double kMajor = 6'378'137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kMinor = kMajor * (1.0 - kFlattening);
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

// Radius of curvature across the meridian [m].
double normal_radius(double sin_latitude) {
  return kMajor / std::sqrt(1.0 - kEccentricity2 * sin_latitude * sin_latitude);
}

// The site's local axes rotated to east, north, up.
Vec3d to_enu(const v1::Georeference& site, const Vec3d& local) {
  const double c = std::cos(site.rotation_deg() * kDegree);
  const double s = std::sin(site.rotation_deg() * kDegree);
  return {c * local.x - s * local.y, s * local.x + c * local.y, local.z};
}

// Earth-centred, Earth-fixed [m].
Vec3d to_geocentric(const v1::Georeference& site, const Vec3d& enu) {
  const double sin_lat = std::sin(site.latitude_deg() * kDegree);
  const double cos_lat = std::cos(site.latitude_deg() * kDegree);
  const double sin_lon = std::sin(site.longitude_deg() * kDegree);
  const double cos_lon = std::cos(site.longitude_deg() * kDegree);
  const double radius = normal_radius(sin_lat);
  const double height = site.altitude_m();
  const Vec3d origin{(radius + height) * cos_lat * cos_lon,
                     (radius + height) * cos_lat * sin_lon,
                     (radius * (1.0 - kEccentricity2) + height) * sin_lat};
  const Vec3d east{-sin_lon, cos_lon, 0.0};
  const Vec3d north{-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat};
  const Vec3d up{cos_lat * cos_lon, cos_lat * sin_lon, sin_lat};
  return origin + enu.x * east + enu.y * north + enu.z * up;
}

// [Bowring]: one step from the parametric latitude; off by less than a nanometre near the ground.
GeodeticPoint from_geocentric(const Vec3d& p) {
  const double from_axis = std::hypot(p.x, p.y);
  const double parametric = std::atan2(p.z * kMajor, from_axis * kMinor);
  const double sin3 = std::pow(std::sin(parametric), 3);
  const double cos3 = std::pow(std::cos(parametric), 3);
  const double second2 = (kMajor * kMajor - kMinor * kMinor) / (kMinor * kMinor);
  const double latitude =
      std::atan2(p.z + second2 * kMinor * sin3, from_axis - kEccentricity2 * kMajor * cos3);
  const double sin_lat = std::sin(latitude);
  const double altitude =
      from_axis * std::cos(latitude) + p.z * sin_lat - kMajor * kMajor / normal_radius(sin_lat);
  return {latitude / kDegree, std::atan2(p.y, p.x) / kDegree, altitude};
}

}  // namespace

GeodeticPoint to_geodetic(const v1::Georeference& site, const Vec3d& local) {
  return from_geocentric(to_geocentric(site, to_enu(site, local)));
}

double course_deg(const v1::Georeference& site, double x, double y) {
  const Vec3d enu = to_enu(site, {x, y, 0.0});
  const double course = std::atan2(enu.x, enu.y) / kDegree;
  return course < 0.0 ? course + 360.0 : course;
}

}  // namespace rayloc
