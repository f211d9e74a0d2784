// Directions as angles, and the unit vectors theta^ and phi^ of a direction.
//
// theta: zenith from +z; phi: azimuth from +x to +y; radians. On the z axis, where phi is
// undefined, phi = 0. The angles come from atan2, which is differentiable wherever they are.
#pragma once

#include <cmath>

#include "engine/base/vec3.h"

namespace rayloc {

struct SphericalAngles {
  double theta = 0.0;
  double phi = 0.0;
};

inline SphericalAngles spherical_angles(const Vec3d& direction) {
  const double horizontal = std::hypot(direction.x, direction.y);
  // atan2 would give pi for y = 0, x = -0.
  return {std::atan2(horizontal, direction.z),
          horizontal > 0.0 ? std::atan2(direction.y, direction.x) : 0.0};
}

template <typename T>
struct SphericalBasis {
  T cos_theta{};
  T sin_theta{};
  Vec3<T> theta_hat;
  Vec3<T> phi_hat;
};

// REQUIRES: norm(direction) == 1.
template <typename T>
SphericalBasis<T> spherical_basis(const Vec3<T>& direction) {
  using std::sqrt;
  const T horizontal2 = direction.x * direction.x + direction.y * direction.y;
  if (!(horizontal2 > T(0))) {
    return {direction.z, T(0), {direction.z, T(0), T(0)}, {T(0), T(1), T(0)}};
  }
  const T sin_theta = sqrt(horizontal2);
  const T cos_phi = direction.x / sin_theta;
  const T sin_phi = direction.y / sin_theta;
  const T& cos_theta = direction.z;
  return {cos_theta,
          sin_theta,
          {cos_theta * cos_phi, cos_theta * sin_phi, -sin_theta},
          {-sin_phi, cos_phi, T(0)}};
}

}  // namespace rayloc
