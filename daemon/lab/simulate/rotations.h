// Rotations other than yaw, pitch and roll: about any axis, and compositions.
#pragma once

#include <algorithm>
#include <cmath>

#include "engine/base/mat3.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

// Applies b, then a.
inline Mat3d operator*(const Mat3d& a, const Mat3d& b) {
  return {transpose_times(b, a.row0), transpose_times(b, a.row1), transpose_times(b, a.row2)};
}

// By `angle` [rad] about a unit vector.
inline Mat3d rotation_about(const Vec3d& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Vec3d part = (1.0 - c) * axis;
  return {{part.x * axis.x + c, part.x * axis.y - s * axis.z, part.x * axis.z + s * axis.y},
          {part.y * axis.x + s * axis.z, part.y * axis.y + c, part.y * axis.z - s * axis.x},
          {part.z * axis.x - s * axis.y, part.z * axis.y + s * axis.x, part.z * axis.z + c}};
}

// The yaw, pitch and roll of a rotation; at a pitch of +-90 degrees, all of the rotation is yaw.
inline Orientation orientation_of(const Mat3d& r) {
  constexpr double kStraight = 1.0 - 1e-12;  // the sine of a pitch of 90 degrees, as rounded
  const double pitch = std::asin(std::clamp(-r.row2.x, -1.0, 1.0));
  if (std::abs(r.row2.x) > kStraight) {
    return {std::atan2(-r.row0.y, r.row1.y), pitch, 0.0};
  }
  return {std::atan2(r.row1.x, r.row0.x), pitch, std::atan2(r.row2.y, r.row2.z)};
}

}  // namespace rayloc
