// Placing: rotation, scale, shear and translation in the plane, as in drawings.
#pragma once

#include <cmath>

#include "engine/base/outline.h"

namespace rayloc {

struct Placing {
  double xx = 1.0, xy = 0.0, yx = 0.0, yy = 1.0;
  double x = 0.0, y = 0.0;

  FloorPoint operator()(const FloorPoint& p) const {
    return {xx * p[0] + xy * p[1] + x, yx * p[0] + yy * p[1] + y};
  }
  // Applies `inner` first, then this.
  Placing after(const Placing& inner) const {
    const FloorPoint at = (*this)({inner.x, inner.y});
    return {xx * inner.xx + xy * inner.yx,
            xx * inner.xy + xy * inner.yy,
            yx * inner.xx + yy * inner.yx,
            yx * inner.xy + yy * inner.yy,
            at[0],
            at[1]};
  }
};

// By an angle [rad], from +x to +y.
inline Placing rotated_by(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {c, -s, s, c};
}

}  // namespace rayloc
