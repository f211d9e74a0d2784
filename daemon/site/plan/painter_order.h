// The painter's order: faces sorted so that each may be painted over those before it.
//
// A binary space partition (Fuchs, Kedem and Naylor, SIGGRAPH 1980): faces that cut through others
// split them, so the order is right where sorting by distance is not. Above kMaxSplit faces, where
// a picture is uniformly grey anyway, they are sorted by the distance of their centres.
#pragma once

#include <cstddef>
#include <vector>

#include "daemon/site/plan/face.h"
#include "engine/base/vec3.h"

namespace rayloc::draw {

inline constexpr std::size_t kMaxSplit = 5'000;

// From the back to the front, for a viewer infinitely far away in the direction `towards_viewer`.
std::vector<Face> painter_order(std::vector<Face> faces, const Vec3d& towards_viewer);

}  // namespace rayloc::draw
