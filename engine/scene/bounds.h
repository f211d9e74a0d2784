// Bounds: the smallest axis-aligned box around some points.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

struct Bounds {
  Vec3d lower{std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity(),
              std::numeric_limits<double>::infinity()};
  Vec3d upper = -lower;

  void include(const Vec3d& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  Vec3d size() const { return upper - lower; }
  bool contains(const Vec3d& p) const {
    return lower.x <= p.x && p.x <= upper.x && lower.y <= p.y && p.y <= upper.y && lower.z <= p.z &&
           p.z <= upper.z;
  }
};

// Bounds of the vertices that triangles use.
inline Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      bounds.include(mesh.vertices[index]);
    }
  }
  return bounds;
}

}  // namespace rayloc
