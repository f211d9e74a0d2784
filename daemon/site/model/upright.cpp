#include "daemon/site/model/upright.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

namespace rayloc {
namespace {

using Vector = std::array<double, 3>;

Vector as_array(const Vec3d& v) { return {v.x, v.y, v.z}; }

Vector middle_of(const Surface& surface) {
  Vec3d sum;
  for (const Vec3d& corner : surface.outline()) {
    sum = sum + corner;
  }
  return as_array((1.0 / static_cast<double>(surface.outline().size())) * sum);
}

bool has_word(const std::string& name, std::initializer_list<std::string_view> words) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    return lower.find(word) != std::string::npos;
  });
}

// The faces of all objects of one kind.
struct Kind {
  double area = 0.0;  // [m^2]
  Vector across{};    // area of faces across each axis [m^2]
  Vector moment{};    // area times position, along each axis

  void add(const Surface& surface) {
    const Vector normal = as_array(surface.plane().normal);
    const Vector middle = middle_of(surface);
    area += surface.area();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr double kAcross = 0.97;  // 14 degrees
      across.at(axis) += std::abs(normal.at(axis)) > kAcross ? surface.area() : 0.0;
      moment.at(axis) += surface.area() * middle.at(axis);
    }
  }
  bool lies_across(std::size_t axis) const {
    constexpr double kMost = 0.8;
    return area > 0.0 && across.at(axis) > kMost * area;
  }
  double place(std::size_t axis) const { return moment.at(axis) / area; }
};

// The minimum area of a rectangle around the scene as seen along the axis [m^2], within a few
// percent: a corridor may be oblique to the axes.
double footprint(const Scene& scene, std::size_t axis) {
  constexpr int kDirections = 18;
  const std::size_t u = (axis + 1) % 3;
  const std::size_t v = (axis + 2) % 3;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kDirections; ++i) {
    const double angle = i * std::numbers::pi / 2.0 / kDirections;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    Vector low = {
        std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), 0.0};
    Vector high = {-low[0], -low[1], 0.0};
    for (const Surface& surface : scene.surfaces()) {
      for (const Vec3d& corner : surface.outline()) {
        const Vector p = as_array(corner);
        const Vector rotated = {c * p.at(u) + s * p.at(v), c * p.at(v) - s * p.at(u), 0.0};
        for (std::size_t k = 0; k < 2; ++k) {
          low.at(k) = std::min(low.at(k), rotated.at(k));
          high.at(k) = std::max(high.at(k), rotated.at(k));
        }
      }
    }
    least = std::min(least, (high[0] - low[0]) * (high[1] - low[1]));
  }
  return least;
}

}  // namespace

std::optional<NamedUp> wrong_up_by_name(const Scene& scene) {
  Kind floor;
  Kind ceiling;
  double all = 0.0;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    const Surface& surface = scene.surfaces()[i];
    const std::string name =
        scene.objects()[scene.owner(i).object].name + " " + scene.material_of(i).name;
    all += surface.area();
    if (has_word(name, {"wall", "window", "door"})) {  // "window_floor_to_ceiling"
      continue;
    }
    if (has_word(name, {"ceiling", "roof"})) {
      ceiling.add(surface);
    } else if (has_word(name, {"floor", "ground"})) {
      floor.add(surface);
    }
  }
  const Vector size = as_array(scene.bounds_max() - scene.bounds_min());
  for (const std::size_t axis : {1U, 0U}) {
    const bool both = floor.lies_across(axis) && ceiling.lies_across(axis);
    constexpr double kMinShare = 0.1;
    if (both && std::abs(floor.place(axis) - ceiling.place(axis)) > 0.5 * size.at(axis)) {
      return NamedUp{axis, true};
    }
    if ((floor.lies_across(axis) && floor.area > kMinShare * all && ceiling.area == 0.0) ||
        (ceiling.lies_across(axis) && ceiling.area > kMinShare * all && floor.area == 0.0)) {
      return NamedUp{axis, false};
    }
  }
  return std::nullopt;
}

int large_faces(const Scene& scene, std::size_t axis) {
  constexpr double kFlat = 0.5;        // cosine of 60 degrees: below that a roof is a wall
  constexpr double kLowest = 1.0 / 3;  // share of the height
  constexpr double kLarge = 0.15;      // share of the footprint: a ring of corridors covers 1/4
  const Vector low = as_array(scene.bounds_min());
  const Vector size = as_array(scene.bounds_max() - scene.bounds_min());
  double floor = 0.0;
  double ceiling = 0.0;
  for (const Surface& surface : scene.surfaces()) {
    const double cosine = std::abs(as_array(surface.plane().normal).at(axis));
    const double height = middle_of(surface).at(axis) - low.at(axis);
    if (cosine > kFlat) {
      (height < kLowest * size.at(axis) ? floor : ceiling) += cosine * surface.area();
    }
  }
  const double large = kLarge * footprint(scene, axis);
  return (floor > large ? 1 : 0) + (ceiling > large ? 1 : 0);
}

}  // namespace rayloc
