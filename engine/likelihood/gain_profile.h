// The complex factor that a measurement is known up to, profiled out of a Gaussian: of
// 2 D ln r - a r^2 + 2 b r, with a = |W y|^2 > 0 and b = |(W mu)^H W y|, the maximum over r > 0.
// LaneKernel has the same for eight at a time.
#pragma once

#include <cmath>

namespace rayloc {

// The r.
inline double best_gain(double a, double b, double dimension) {
  return (b + std::sqrt(b * b + 4.0 * a * dimension)) / (2.0 * a);
}

// The maximum.
inline double gain_profile(double a, double b, double dimension) {
  const double r = best_gain(a, b, dimension);
  return 2.0 * dimension * std::log(r) - a * r * r + 2.0 * b * r;
}

}  // namespace rayloc
