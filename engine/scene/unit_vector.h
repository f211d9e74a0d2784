// Directions of surfaces.
#pragma once

#include "engine/base/vec3.h"

namespace rayloc {

// A vector of length 1 along `v`.
inline Vec3d unit_vector(const Vec3d& v) {
  const double length = norm(v);
  return {v.x / length, v.y / length, v.z / length};  // exact for a vector along an axis
}

}  // namespace rayloc
