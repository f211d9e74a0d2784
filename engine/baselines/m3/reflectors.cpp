#include "engine/baselines/m3/reflectors.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr double kMinArea = 1.0;     // [m^2], of a mirror that M3 uses
constexpr double kUpright = 0.02;    // sine of the tilt of a vertical plane, chosen
constexpr double kParallel = 0.999;  // cosine of the angle between the planes of one wall, chosen
constexpr double kThickest = 0.3;    // [m], of a wall, chosen: its two faces form one mirror

bool is_level(const Plane<double>& plane) { return std::abs(plane.normal.z) > 1.0 - kUpright; }

// True for two faces of one wall.
bool is_same_wall(const Plane<double>& a, const Plane<double>& b) {
  const double along = dot(a.normal, b.normal);
  return std::abs(along) > kParallel &&
         std::abs(a.offset - std::copysign(1.0, along) * b.offset) < kThickest;
}

}  // namespace

bool is_vertical(const Plane<double>& plane) { return std::abs(plane.normal.z) < kUpright; }

Vec3d mirrored(const Plane<double>& plane, const Vec3d& place) {
  return place - 2.0 * distance(plane, place) * plane.normal;
}

std::vector<Plane<double>> reflectors_of(const RoomModel& room, const Vec3d& from) {
  std::vector<Plane<double>> all;
  for (const Surface& surface : room.scene->surfaces()) {
    if (surface.area() >= kMinArea && (is_vertical(surface.plane()) || is_level(surface.plane()))) {
      all.push_back(surface.plane());
    }
  }
  const auto away = [&](const Plane<double>& plane) { return std::abs(distance(plane, from)); };
  std::stable_sort(
      all.begin(), all.end(), [&](const auto& a, const auto& b) { return away(a) < away(b); });
  std::vector<Plane<double>> first;
  for (const Plane<double>& plane : all) {
    if (std::none_of(first.begin(), first.end(), [&](const Plane<double>& nearer) {
          return is_same_wall(nearer, plane);
        })) {
      first.push_back(plane);
    }
  }
  return first;
}

}  // namespace rayloc
