// Diffraction at the edge of a wedge: the uniform theory for a perfect
// conductor, soft and hard.
//
// The wedge fills the space outside the azimuths 0 (its face 0) to n pi (its face n) about the
// edge; n = 2 is the free edge of a sheet. A wave comes from the azimuth `from` and is observed at
// the azimuth `to`.
//
// A diffracted wave is expressed relative to a wave that travels the same path length with no edge:
// exp(-j k (s' + s)) / (s' + s) of a point source, with s' and s the distances to the edge along
// the path; exp(-j k s) of a plane wave. In [KP] the factor sqrt(L) of each term and the spreading
// sqrt(s' / (s (s' + s))) combine to exactly this wave, for plane, cylindrical and spherical waves
// alike. So the wavelength enters only through the phase k L.
//
// The terms of [KP] are summed as c(d) G(w): d is the azimuth past a boundary of light, positive in
// the light, c(d) = sin(d / 2) cot(d / 2n), w = sqrt(2 k L) sin(d / 2). Both are smooth at d = 0;
// only the sign jumps, by the jump of the geometrical field there. So derivatives are finite on
// each side of every boundary and at it.
//
// Sheets are exact for plane waves. Limits: at other wedges the error grows as 1 / (k L) and is
// largest for hollow ones of about 105 degrees between the faces (0.05 of the incident wave at half
// a wavelength, 0.014 at two). Where a face is met at grazing incidence, the incident and the
// reflected wave coincide and count half. Where the incident wave has a slope across the edge,
// wedge_slope_terms() have to be added. Where a term has its zero, half way between two boundaries,
// second derivatives jump.
//
// Written in a scalar T, for derivatives by angles and distances. n is a double: the angle of
// a wedge is fixed.
//
// References:
//   [KP] R. G. Kouyoumjian, P. H. Pathak, Proc. IEEE 62 (1974) 1448, equations (25) to (33).
//   [HK] Y. M. Hwang, R. G. Kouyoumjian, URSI meeting (1974): the slope of (25) by the azimuth.
#pragma once

#include <cmath>
#include <numbers>

#include "engine/base/complex.h"
#include "engine/base/dual.h"
#include "engine/em/wedge_transition.h"

namespace rayloc {

// The parameters of diffraction at one edge.
template <typename T>
struct WedgeRay {
  double n = 2.0;    // exterior angle over pi, in (0, 2]
  T from{};          // [rad], azimuth of the source, in [0, n pi]
  T to{};            // [rad], azimuth of the observer, in [0, n pi]
  T phase_length{};  // k L = k s' s / (s' + s) sin^2(angle of the path to the edge) [rad], > 0
};

// The parts of a diffracted wave, by the boundary at which each restores continuity.
template <typename T>
struct WedgeTerms {
  Complex<T> incident;     // both boundaries of shadow
  Complex<T> reflected_0;  // the boundary of the reflection at face 0
  Complex<T> reflected_n;  // the boundary of the reflection at face n
};

// Electric field along the edge: 0 on the faces.
template <typename T>
Complex<T> soft(const WedgeTerms<T>& terms) {
  return terms.incident - (terms.reflected_0 + terms.reflected_n);
}
// Magnetic field along the edge: its slope is 0 on the faces.
template <typename T>
Complex<T> hard(const WedgeTerms<T>& terms) {
  return terms.incident + (terms.reflected_0 + terms.reflected_n);
}

namespace wedge {

template <typename T>
struct ValueAndSlope {
  T value{};
  T slope{};
};

// sin(x) / x and its slope.
template <typename T>
ValueAndSlope<T> sinc(const T& x) {
  using std::cos;
  using std::sin;
  // Below this, terms beyond the series are less than the rounding of a double.
  constexpr double kSmall = 0.1;
  const T x2 = x * x;
  if (std::abs(value_of(x)) < kSmall) {
    return {T(1) - x2 / T(6) * (T(1) - x2 / T(20) * (T(1) - x2 / T(42) * (T(1) - x2 / T(72)))),
            -x / T(3) * (T(1) - x2 / T(10) * (T(1) - x2 / T(28) * (T(1) - x2 / T(54))))};
  }
  const T value = sin(x) / x;
  return {value, (cos(x) - value) / x};
}

// c(d) = sin(d / 2) cot(d / 2n), n at d = 0, and its slope.
template <typename T>
ValueAndSlope<T> pole(double n, const T& d) {
  using std::cos;
  using std::sin;
  const T half = d / T(2);
  const T part = half / T(n);
  const ValueAndSlope<T> above = sinc(half);
  const ValueAndSlope<T> below = sinc(part);
  const T ratio = T(n) * above.value / below.value;
  const T ratio_slope = (T(n) * above.slope - ratio * below.slope / T(n)) / below.value;
  return {ratio * cos(part), (ratio_slope * cos(part) - ratio * sin(part) / T(n)) / T(2)};
}

// One of the four terms, as a function of b = +-(to -+ from), and its slope by b.
template <typename T>
ValueAndSlope<Complex<T>> term(double n, const T& b, const T& phase_length) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const double turn = 2.0 * std::numbers::pi * n;
  const T past = b + T(std::numbers::pi);
  // Azimuth from the nearest boundary.
  const T d = past - T(turn * std::round(value_of(past) / turn));
  const T sign(value_of(d) < 0.0 ? -1.0 : 1.0);
  const T root = sqrt(T(2) * phase_length);
  const ValueAndSlope<T> c = pole(n, d);
  const T w = sign * root * sin(d / T(2));
  const WedgeTransition<T> g = wedge_transition(value_of(w) < 0.0 ? -w : w);
  // -exp(-j pi / 4) / (2 n sqrt(pi))
  const double size = std::numbers::inv_sqrtpi * std::numbers::sqrt2 / (4.0 * n);
  const Complex<T> scale{T(-size), T(size)};
  // dG/dw = 2 j (w G - 1), dw/dd = sign root cos(d / 2) / 2
  const T along = root * cos(d / T(2)) * c.value;
  return {
      scale * Complex<T>{sign * c.value, T(0)} * g.value,
      scale * (Complex<T>{sign * c.slope, T(0)} * g.value + Complex<T>{T(0), along} * g.excess)};
}

}  // namespace wedge

// Exactly on a boundary the geometrical wave must be counted as present.
template <typename T>
WedgeTerms<T> wedge_terms(const WedgeRay<T>& ray) {
  const T difference = ray.to - ray.from;
  const T sum = ray.to + ray.from;
  const auto at = [&](const T& b) { return wedge::term(ray.n, b, ray.phase_length).value; };
  return {at(difference) + at(-difference), at(-sum), at(sum)};
}

// Derivatives of the terms by `from`. A wave that vanishes at the edge, with the slope du/dn across
// the path and the edge towards larger azimuths, is diffracted as du/dn / (j k sin(angle of the
// path to the edge)) times these.
template <typename T>
WedgeTerms<T> wedge_slope_terms(const WedgeRay<T>& ray) {
  const T difference = ray.to - ray.from;
  const T sum = ray.to + ray.from;
  const auto at = [&](const T& b) { return wedge::term(ray.n, b, ray.phase_length).slope; };
  return {at(-difference) - at(difference), Complex<T>{} - at(-sum), at(sum)};
}

}  // namespace rayloc
