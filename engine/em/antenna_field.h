// antenna_field: the far field that an antenna radiates in a direction, as a real vector of the
// world; its length is the square root of the gain. By reciprocity the same vector receives.
//
// A short dipole and a half-wave dipole lie along the z axis of their own frame.
//
// References:
//   [B] Balanis, Antenna Theory, (4-84) and (4-91): half-wave dipole, directivity 1.643.
#pragma once

#include <cmath>
#include <numbers>

#include "engine/base/mat3.h"
#include "engine/em/antenna_pattern.h"
#include "engine/em/spherical.h"

namespace rayloc {

// Amplitude (square root of the gain) at a zenith angle of the antenna's own frame.
template <typename T>
T pattern_amplitude(AntennaPattern pattern, const T& cos_theta, const T& sin_theta) {
  using std::sin;
  switch (pattern) {
    case AntennaPattern::kDipole:
      return T(std::sqrt(1.5)) * sin_theta;
    case AntennaPattern::kHalfWaveDipole:
      if (!(sin_theta > T(0))) {
        return T(0);  // the limit on the axis
      }
      {
        // cos(pi/2 cos_theta) = sin(pi/2 (1 - cos_theta)), which does not cancel near the axis.
        const T c = cos_theta < T(0) ? -cos_theta : cos_theta;
        const T one_minus_c = sin_theta * sin_theta / (T(1) + c);
        return T(std::sqrt(1.643)) * sin(T(std::numbers::pi / 2) * one_minus_c) / sin_theta;
      }
    case AntennaPattern::kIsotropic:
      break;
  }
  return T(1);
}

// `direction` leaves the antenna (a receiver's points to where the wave comes from).
// REQUIRES: norm(direction) == 1.
template <typename T>
Vec3<T> antenna_field(AntennaPattern pattern,
                      Polarization polarization,
                      const Mat3<T>& world_from_antenna,
                      const Vec3<T>& direction) {
  const SphericalBasis<T> basis = spherical_basis(transpose_times(world_from_antenna, direction));
  const T amplitude = pattern_amplitude(pattern, basis.cos_theta, basis.sin_theta);
  return amplitude * (world_from_antenna *
                      (polarization == Polarization::kVertical ? basis.theta_hat : basis.phi_hat));
}

}  // namespace rayloc
