// orientation: the side of a line on which a point of a plane lies, without rounding.
//
// References: J. R. Shewchuk, Discrete Comput. Geom. 18 (1997) 305.
#pragma once

namespace rayloc {

// A point of a surface's plane, in the surface's own coordinates [m].
struct Point2 {
  double u, v;

  friend constexpr bool operator==(const Point2&, const Point2&) = default;
};

// +1: `c` is to the left of the line from `a` to `b`, that is a, b, c run anticlockwise; -1: to the
// right; 0: exactly on it. REQUIRES: coordinates are finite and no products of them underflow.
int orientation(const Point2& a, const Point2& b, const Point2& c);

}  // namespace rayloc
