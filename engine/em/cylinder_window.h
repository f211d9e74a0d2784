// The wave behind a straight edge, and the scattered share of an upright body of finite height.
//
// The field that an infinite cylinder scatters comes from its whole height, but by its phases
// mainly from around one point. A body that ends there scatters knife_edge() of it, one that
// extends from u_low to u_high the difference.
//
// References:
//   [P526] Rec. ITU-R P.526-15, section 4.1.
#pragma once

#include "engine/base/complex.h"

namespace rayloc {

// (1 + j) / 2 times the integral of exp(-j pi t^2 / 2) from minus infinity to u: 0 far below the
// edge, 1/2 at it, 1 above. Error below 1e-12.
Complex<double> knife_edge(double u);

// Its derivative by u.
Complex<double> knife_edge_slope(double u);

}  // namespace rayloc
