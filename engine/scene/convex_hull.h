// convex_hull: the corners of the convex outline of points in a plane.
#pragma once

#include <vector>

#include "engine/scene/orientation.h"

namespace rayloc {

// Anticlockwise. Every corner is one of `points`. The choice of corners is exact, so no true corner
// is lost however many points share a side. Only then are corners left out that lie on the straight
// line between others: no point is further than `tolerance` [m] outside the result. Fewer than
// three corners: the points lie on a line.
std::vector<Point2> convex_hull(std::vector<Point2> points, double tolerance);

}  // namespace rayloc
