// piece_corners: the corners of a convex piece of a surface.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// [m], world: intersections of successive edges, the first edge's end first.
std::vector<Vec3d> piece_corners(const Surface& surface, const Surface::Piece& piece);

}  // namespace rayloc
