// disjoint_triangles: the area that triangles cover, without a point covered twice.
//
// Modellers overlap strips at the corners of a frame, and export both faces of a wall in one mesh.
// Areas and boundaries are only correct where no triangle overlaps another.
#pragma once

#include <span>
#include <vector>

#include "engine/scene/boundary.h"

namespace rayloc {

// The unchanged triangles where none overlaps another by more than `tolerance` [m], which is the
// usual case. Otherwise the parts of each that no earlier one covers; parts thinner than
// `tolerance` are left out. Corners of the result may lie on the sides of others.
std::vector<Triangle2> disjoint_triangles(std::span<const Triangle2> triangles, double tolerance);

}  // namespace rayloc
