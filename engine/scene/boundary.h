// boundary_of: where the triangles of a surface end.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/scene/orientation.h"

namespace rayloc {

using Triangle2 = std::array<Point2, 3>;

struct Side {
  Point2 from, to;
};

// The sides of the triangles that have a triangle on one side only; those that triangles share lie
// inside, also where one of them has corners on the side of another. Corners no further apart than
// `tolerance` [m] are one. REQUIRES: triangles do not overlap (disjoint_triangles.h); else sides
// within the surface may be among the result.
std::vector<Side> boundary_of(std::span<const Triangle2> triangles, double tolerance);

// Each triangle once, however often it is there and whichever way round.
std::vector<Triangle2> without_doubles(std::vector<Triangle2> triangles);

}  // namespace rayloc
