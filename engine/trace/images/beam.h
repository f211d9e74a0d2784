// Beams: what a mirror sends out, bounded by planes; and windows, the parts of surfaces that a beam
// lights. Windows are kept a little too wide, so that rounding cannot cut a path off.
#pragma once

#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// A beam is kept this much wider than it is [m].
inline constexpr double kBeamMargin = 1e-7;

using Polygon = std::vector<Vec3d>;  // convex and plane

// Whether no corner is in front of the plane.
bool is_outside(const Plane<double>& plane, std::span<const Vec3d> polygon);

// Cuts off what lies behind the plane. `scratch`: memory to work in.
void clip(const Plane<double>& plane, Polygon& polygon, Polygon& scratch);

// A convex outline, anticlockwise seen from where `normal` points to, with its edges moved outwards
// by `margin`.
Polygon grown(std::span<const Vec3d> outline, const Vec3d& normal, double margin);

// The planes through the sides of `window`, looking inwards, that hold what the apexes see through
// it. `window`: its corners come anticlockwise seen from where the normal of its plane points to;
// `side`: by its sign, of which side of that plane the apexes are (all on one). A side seen end on
// bounds nothing that rounding could not move, so it is left out. REQUIRES: apexes is not empty.
void beam_planes(std::span<const Vec3d> apexes,
                 double side,
                 std::span<const Vec3d> window,
                 std::vector<Plane<double>>& planes);

// The plane turned so that `point` is behind it.
inline Plane<double> facing_away(const Plane<double>& plane, const Vec3d& point) {
  return distance(plane, point) < 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset};
}

}  // namespace rayloc
