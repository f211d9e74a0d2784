// The odds of a share on an unbounded scale, on which shares near 0 and near 1 are comparable.
#pragma once

#include <algorithm>
#include <cmath>

namespace rayloc {

// ln(share / (1 - share)); shares nearer than 1e-6 to an end are clamped to that distance.
inline double log_odds(double share) {
  constexpr double kNearest = 1e-6;  // a ratio, chosen: +-13.8 at the most
  const double bounded = std::clamp(share, kNearest, 1.0 - kNearest);
  return std::log(bounded / (1.0 - bounded));
}

}  // namespace rayloc
