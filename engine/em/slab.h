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
  // Difference of the parallel from the perpendicular coefficients, over sin^2(theta): (r_te +
  // r_tm) / sin^2 and (t_tm - t_te) / sin^2. Both are regular at normal incidence, where the plane
  // of incidence and with it te and tm are undefined (trace/interactions/wave.h).
  Complex<T> r_excess, t_excess;
};

// Reflection by a half space, for a wave arriving from vacuum; t_te and t_tm are 0, since no wave
// leaves it again. Arguments as below.
template <typename T>
SlabCoefficients<T> half_space_coefficients(const T& cos_theta,
                                            const Complex<T>& relative_permittivity) {
  const T sin2_theta = T(1) - cos_theta * cos_theta;
  const Complex<T> c{cos_theta, T(0)};
  const Complex<T> root = sqrt(relative_permittivity - Complex<T>{sin2_theta, T(0)});
  const Complex<T> te = c + root;
  const Complex<T> tm = relative_permittivity * c + root;
  // [P2040] (37a), (37b). Their sum: eta c^2 - root^2 = (1 - eta) sin^2, simplified by hand.
  const Complex<T> one{T(1), T(0)};
  return {(c - root) / te,
          (relative_permittivity * c - root) / tm,
          {},
          {},
          Complex<T>{T(2), T(0)} * (one - relative_permittivity) / (te * tm),
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
  const Complex<T> root = sqrt(relative_permittivity - Complex<T>{sin2_theta, T(0)});
  const SlabCoefficients<T> half_space = half_space_coefficients(cos_theta, relative_permittivity);
  const Complex<T>& p_te = half_space.r_te;
  const Complex<T>& p_tm = half_space.r_tm;

  // [P2040] (44): phase and loss of one crossing.
  const T k_d = T(2.0 * std::numbers::pi) * thickness / wavelength;
  const Complex<T> q{k_d * root.re, k_d * root.im};
  const Complex<T> once = exp(Complex<T>{q.im, -q.re});  // exp(-jq)
  const Complex<T> twice = once * once;                  // exp(-2jq)

  // [P2040] (43): sum over the internal reflections.
  const Complex<T> from_te = one / (one - p_te * p_te * twice);
  const Complex<T> from_tm = one / (one - p_tm * p_tm * twice);
  const Complex<T> r_te = p_te * (one - twice) * from_te;
  const Complex<T> r_tm = p_tm * (one - twice) * from_tm;
  const Complex<T> t_te = (one - p_te * p_te) * once * from_te;
  const Complex<T> t_tm = (one - p_tm * p_tm) * once * from_tm;
  // r_te + r_tm and t_tm - t_te with p_te + p_tm factored out.
  const Complex<T> common = half_space.r_excess * (one - twice) * from_te * from_tm;
  return {
      r_te, r_tm, t_te, t_tm, common * (one - p_te * p_tm * twice), common * (p_te - p_tm) * once};
}

}  // namespace rayloc
