// Probability that a normally distributed point of the plane lies inside a polygon.
//
// Exact except for quadrature: the error is below 1e-9 for every polygon and every covariance. A
// covariance that is not positive definite, or has a deviation below a tenth of a millimetre, is
// used with that deviation: nearly all the probability is then at one point.
#pragma once

#include <array>
#include <span>

namespace rayloc {

struct PlanarGaussian {
  std::array<double, 2> mean{};  // [m]
  double variance_x = 0.0;       // [m^2]
  double covariance_xy = 0.0;
  double variance_y = 0.0;
};

// `corners`: of a simple polygon, in either direction; at least three. The result is in [0, 1].
// REQUIRES: all numbers are finite.
double gaussian_in_polygon(const PlanarGaussian& gaussian,
                           std::span<const std::array<double, 2>> corners);

}  // namespace rayloc
