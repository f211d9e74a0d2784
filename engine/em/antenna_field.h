// antenna_field: far field that an antenna radiates in a direction, as a real vector in the world
// frame; its length is the square root of the gain. By reciprocity it also applies to reception.
//
// Derivatives. On the axis of its frame, where phi is undefined, phi = 0 and its derivative is 0.
// "tr38901" has kinks where it reaches its floor (30 dB below its maximum) and is cut off by it;
// there the derivative is that of one side. Its gain, and that of a table, may depend on phi up to
// the axis itself: near it derivatives by the direction grow as 1 / sin(theta).
//
// References: antenna_pattern.h.
#pragma once

#include <cmath>
#include <numbers>

#include "engine/base/mat3.h"
#include "engine/em/antenna_pattern.h"
#include "engine/em/spherical.h"

namespace rayloc {

// [B] (4-84), cos(pi/2 cos_theta) / sin_theta with the gain's maximum.
template <typename T>
T half_wave_dipole_amplitude(const T& cos_theta, const T& sin_theta) {
  using std::sin;
  if (!(sin_theta > T(0))) {
    return T(0);  // the limit on the axis
  }
  // cos(pi/2 cos_theta) = sin(pi/2 (1 - cos_theta)), which does not cancel near the axis.
  const T c = cos_theta < T(0) ? -cos_theta : cos_theta;
  const T one_minus_c = sin_theta * sin_theta / (T(1) + c);
  return T(std::sqrt(1.643)) * sin(T(std::numbers::pi / 2) * one_minus_c) / sin_theta;
}

// [38.901] table 7.3-1 [dBi]; theta in [0, pi], phi in [-pi, pi].
template <typename T>
T tr38901_gain_dbi(const T& theta, const T& phi) {
  // [rad], 3GPP TR 38.901 table 7.3-1: 65 degrees at -3 dB.
  constexpr double kBeamwidth = 65.0 * std::numbers::pi / 180.0;
  const T floor(30.0);  // [dB], SLA_V and A_max alike
  const auto at_most_floor = [&](const T& loss) { return loss < floor ? loss : floor; };
  const T above = (theta - T(std::numbers::pi / 2)) / T(kBeamwidth);
  const T aside = phi / T(kBeamwidth);
  const T vertical = at_most_floor(T(12) * above * above);
  const T horizontal = at_most_floor(T(12) * aside * aside);
  return T(8) - at_most_floor(vertical + horizontal);
}

// The number without its derivatives.
inline double plain(double x) { return x; }
template <typename Dual>
double plain(const Dual& x) {
  return x.a;  // ceres::Jet
}

template <typename T>
T table_gain_dbi(const AntennaGainTable& table, const T& theta, const T& phi) {
  const AntennaGainTable::Gain gain = table.at(plain(theta), plain(phi));
  return T(gain.dbi) + T(gain.by_theta) * (theta - T(plain(theta))) +
         T(gain.by_phi) * (phi - T(plain(phi)));
}

// Square root of the gain in a direction of the antenna's own frame.
template <typename T>
T pattern_amplitude(const AntennaPattern& pattern, const SphericalBasis<T>& direction) {
  using std::atan2;
  using std::exp;
  const auto theta = [&] { return atan2(direction.sin_theta, direction.cos_theta); };
  const auto phi = [&] { return atan2(-direction.phi_hat.x, direction.phi_hat.y); };
  const auto amplitude = [](const T& dbi) { return exp(T(std::numbers::ln10 / 20.0) * dbi); };
  switch (pattern.kind()) {
    case AntennaPattern::kDipole:
      return T(std::sqrt(1.5)) * direction.sin_theta;
    case AntennaPattern::kHalfWaveDipole:
      return half_wave_dipole_amplitude(direction.cos_theta, direction.sin_theta);
    case AntennaPattern::kTr38901:
      return amplitude(tr38901_gain_dbi(theta(), phi()));
    case AntennaPattern::kTable:
      return amplitude(table_gain_dbi(pattern.table(), theta(), phi()));
    case AntennaPattern::kIsotropic:
      break;
  }
  return T(1);
}

// `direction` points away from the antenna (for a receiver, towards the arriving wave). REQUIRES:
// norm(direction) == 1.
template <typename T>
Vec3<T> antenna_field(const AntennaPattern& pattern,
                      Polarization polarization,
                      const Mat3<T>& world_from_antenna,
                      const Vec3<T>& direction) {
  const SphericalBasis<T> basis = spherical_basis(transpose_times(world_from_antenna, direction));
  return pattern_amplitude(pattern, basis) *
         (world_from_antenna *
          (polarization == Polarization::kVertical ? basis.theta_hat : basis.phi_hat));
}

}  // namespace rayloc
