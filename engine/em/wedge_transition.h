// The transition function of the uniform theory of diffraction: the field about an edge between
// light and shadow (wedge_diffraction.h).
//
// References:
//   [KP] R. G. Kouyoumjian, P. H. Pathak, Proc. IEEE 62 (1974) 1448, equation (28).
#pragma once

#include "engine/base/complex.h"
#include "engine/base/dual.h"

namespace rayloc {

// G(w) = 2 j exp(j w^2) times the integral of exp(-j t^2) from w to infinity. [KP]'s F(w^2) is w
// G(w), whose slope is infinite at w = 0; that of G is not. G is 1 / w for large w.
template <typename T>
struct WedgeTransition {
  Complex<T> value;   // G
  Complex<T> excess;  // w G - 1, without the cancellation; half of -j dG/dw
};

// REQUIRES: w >= 0. Errors are below 1e-12, relative, and 1e-10 of the excess.
WedgeTransition<double> wedge_transition(double w);

template <typename T>
WedgeTransition<T> wedge_transition(const T& w) {
  const double at = value_of(w);
  const WedgeTransition<double> g = wedge_transition(at);
  // dG/dw = 2 j (w G - 1); d(w G - 1)/dw = G + w dG/dw.
  const Complex<double> slope{-2.0 * g.excess.im, 2.0 * g.excess.re};
  const Complex<double> excess_slope = g.value + Complex<double>{at, 0.0} * slope;
  return {{composed(w, g.value.re, slope.re), composed(w, g.value.im, slope.im)},
          {composed(w, g.excess.re, excess_slope.re), composed(w, g.excess.im, excess_slope.im)}};
}

}  // namespace rayloc
