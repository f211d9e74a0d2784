// Projection: parallel projection of the world to the page.
#pragma once

#include <cmath>

#include "daemon/site/plan/drawing.h"
#include "engine/base/vec3.h"

namespace rayloc::draw {

struct Projection {
  Vec3d right;  // unit vectors in the world along the page's right and top
  Vec3d up;
  Vec3d towards_viewer;
  double scale = 1.0;  // pixels per metre, in the plane of the page
  PagePoint origin;    // position of the world's origin on the page

  PagePoint operator()(const Vec3d& v) const {
    return {origin.x + scale * dot(right, v), origin.y - scale * dot(up, v)};
  }
};

// From above, x to the right.
inline Projection plan_projection() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1.0, {}}; }

// Isometric, from the south-west and above: x points to the upper right, y to the upper left, and
// lengths along all three axes appear shortened by kIsometric.
inline const double kIsometric = std::sqrt(2.0 / 3.0);
inline Projection isometric_projection() {
  const double a = std::sqrt(0.5);
  const double b = std::sqrt(1.0 / 6.0);
  const double c = std::sqrt(1.0 / 3.0);
  return {{a, -a, 0.0}, {b, b, 2.0 * b}, {-c, -c, c}, 1.0, {}};
}

}  // namespace rayloc::draw
