// Profiles out the unknown complex factor of a measurement in a Gaussian: the maximum over r > 0 of
// 2 D ln r - a r^2 + 2 b r, with a = |W y|^2 > 0 and b = |(W mu)^H W y|. LaneKernel computes the
// same for eight values at a time.
#pragma once

#include <cmath>

namespace rayloc {

// The maximising r.
inline double best_gain(double a, double b, double dimension) {
  return (b + std::sqrt(b * b + 4.0 * a * dimension)) / (2.0 * a);
}

// The maximum.
inline double gain_profile(double a, double b, double dimension) {
  const double r = best_gain(a, b, dimension);
  return 2.0 * dimension * std::log(r) - a * r * r + 2.0 * b * r;
}

}  // namespace rayloc
