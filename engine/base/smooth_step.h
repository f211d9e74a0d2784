// A smooth step from 0 to 1, in a scalar T.
#pragma once

namespace rayloc {

// 0 for x <= 0 (and for NaN), 1 for x >= 1, with three continuous derivatives: differences of
// fourth order confirm the first one.
template <typename T>
T smooth_step(const T& x) {
  if (!(x > T(0))) {
    return T(0);
  }
  if (!(x < T(1))) {
    return T(1);
  }
  const T x2 = x * x;
  return x2 * x2 * (T(35) + x * (T(-84) + x * (T(70) - T(20) * x)));
}

}  // namespace rayloc
