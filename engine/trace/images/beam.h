// Beams: the waves from a mirror, bounded by planes; and windows, the parts of surfaces that a beam
// lights. Windows are kept slightly too wide, so that rounding cannot cut a path off.
#pragma once

#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// A beam is widened by this margin [m].
inline constexpr double kBeamMargin = 1e-7;

using Polygon = std::vector<Vec3d>;  // convex and planar

// True if no corner is in front of the plane.
bool is_outside(const Plane<double>& plane, std::span<const Vec3d> polygon);

// Removes the part behind the plane. `scratch`: working memory.
void clip(const Plane<double>& plane, Polygon& polygon, Polygon& scratch);

// A convex outline, anticlockwise as seen from the side of `normal`, with its edges moved
// outwards by `margin`.
Polygon grown(std::span<const Vec3d> outline, const Vec3d& normal, double margin);

// The planes through the sides of `window`, facing inwards, that bound the apexes' view through it.
// `window`: its corners are anticlockwise as seen from the side of its plane's normal; `side`: its
// sign is the side of that plane where the apexes are (all on one). A side seen end on gives no
// bound that is stable under rounding, so it is left out. REQUIRES: apexes is not empty.
void beam_planes(std::span<const Vec3d> apexes,
                 double side,
                 std::span<const Vec3d> window,
                 std::vector<Plane<double>>& planes);

// The plane oriented so that `point` is behind it.
inline Plane<double> facing_away(const Plane<double>& plane, const Vec3d& point) {
  return distance(plane, point) < 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset};
}

}  // namespace rayloc
