// Reflection and transmission of a plane wave by a single homogeneous slab.
//
// Conventions: time factor exp(+j*omega*t), so a lossy medium has
// Im(relative_permittivity) <= 0. SI units throughout.
//
// References:
//   [P2040] Rec. ITU-R P.2040-3, equations (37a), (37b), (43), (44).
//
// A slab of infinite thickness is a half space: reflection by (37a), (37b) alone, no transmission.
#pragma once

#include <numbers>

#include "engine/base/complex.h"

namespace rayloc {

// Amplitude coefficients referred to the incident face of the slab.
template <typename T>
struct SlabCoefficients {
  Complex<T> r_te, r_tm;  // reflection, electric field perpendicular / parallel
  Complex<T> t_te, t_tm;  // transmission
};

// Reflection by a half space, for a wave arriving from vacuum; t_te and t_tm are 0, since nothing
// comes out again. Arguments as below.
template <typename T>
SlabCoefficients<T> half_space_coefficients(const T& cos_theta,
                                            const Complex<T>& relative_permittivity) {
  const T sin2_theta = T(1) - cos_theta * cos_theta;
  const Complex<T> c{cos_theta, T(0)};
  const Complex<T> root = sqrt(relative_permittivity - Complex<T>{sin2_theta, T(0)});
  // [P2040] (37a), (37b).
  return {(c - root) / (c + root),
          (relative_permittivity * c - root) / (relative_permittivity * c + root),
          {},
          {}};
}

// Coefficients for a wave arriving from vacuum.
//
// cos_theta: cosine of the angle of incidence, in (0, 1].
// relative_permittivity: complex relative permittivity; not the refractive
//   index (optics texts also write eta for that one).
// thickness, wavelength: [m], both > 0.
//
// Differentiable in every argument; a T carrying derivatives may be used.
template <typename T>
SlabCoefficients<T> slab_coefficients(const T& cos_theta,
                                      const Complex<T>& relative_permittivity,
                                      const T& thickness,
                                      const T& wavelength) {
  const T sin2_theta = T(1) - cos_theta * cos_theta;
  const Complex<T> one{T(1), T(0)};
  const Complex<T> c{cos_theta, T(0)};
  const Complex<T> root = sqrt(relative_permittivity - Complex<T>{sin2_theta, T(0)});

  // [P2040] (37a), (37b): half-space coefficients.
  const Complex<T> p_te = (c - root) / (c + root);
  const Complex<T> p_tm = (relative_permittivity * c - root) / (relative_permittivity * c + root);

  // [P2040] (44): phase and loss of one crossing.
  const T k_d = T(2.0 * std::numbers::pi) * thickness / wavelength;
  const Complex<T> q{k_d * root.re, k_d * root.im};
  const Complex<T> once = exp(Complex<T>{q.im, -q.re});  // exp(-jq)
  const Complex<T> twice = once * once;                  // exp(-2jq)

  // [P2040] (43): sum over the internal reflections.
  const auto reflect = [&](Complex<T> p) { return p * (one - twice) / (one - p * p * twice); };
  const auto transmit = [&](Complex<T> p) { return (one - p * p) * once / (one - p * p * twice); };
  return {reflect(p_te), reflect(p_tm), transmit(p_te), transmit(p_tm)};
}

}  // namespace rayloc
