// Outlines of rooms and zones on the floor: closed chains of corners, [m].
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace rayloc {

using FloorPoint = std::array<double, 2>;

// The first edge that meets a non-adjacent edge; the number of corners when there is none. An
// outline is drawn by hand: few corners, so that comparing all pairs costs nothing.
std::size_t first_crossing(std::span<const FloorPoint> outline);

// True if the segments a-b and c-d cross in a point that is an end of neither.
bool segments_cross(const FloorPoint& a,
                    const FloorPoint& b,
                    const FloorPoint& c,
                    const FloorPoint& d);

// [m^2], positive when the corners run anticlockwise.
double signed_area(std::span<const FloorPoint> outline);

// Distance of a point from the line between two others, and position of its foot along the line.
struct FloorDistance {
  double across = 0.0;  // [m]
  double along = 0.0;   // [m], from the first point
};
FloorDistance distance_from_edge(const FloorPoint& from, const FloorPoint& to, const FloorPoint& p);

// True if the point is inside, or no further than `margin` [m] outside.
bool is_within(std::span<const FloorPoint> outline, const FloorPoint& point, double margin);

}  // namespace rayloc
