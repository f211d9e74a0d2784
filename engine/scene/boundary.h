// boundary_of: the boundary of the triangles of a surface.
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

// Sides of triangles with a triangle on one side only; sides shared by two triangles are inside,
// also where one of them has corners on the side of another. Corners no further apart than
// `tolerance` [m] are merged. REQUIRES: triangles do not overlap (disjoint_triangles.h); otherwise
// sides within the surface may be in the result.
std::vector<Side> boundary_of(std::span<const Triangle2> triangles, double tolerance);

// Removes duplicate triangles, of either winding.
std::vector<Triangle2> without_doubles(std::vector<Triangle2> triangles);

}  // namespace rayloc
