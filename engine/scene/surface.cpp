#include "engine/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "engine/scene/convex_hull.h"
#include "engine/scene/overlap/disjoint_triangles.h"
#include "engine/scene/unit_vector.h"

namespace rayloc {
namespace {

using Triangle = std::array<Vec3d, 3>;

// A corner nearer to the line between its neighbours than this is dropped [m]: more than the
// rounding of coordinates within kFarthest of the origin, less than kEdgeTolerance.
constexpr double kStraight = 1e-10;
// Relative difference of areas up to which pieces fill their convex outline.
constexpr double kAreaTolerance = 1e-7;
constexpr double kLengthTolerance = 1e-5;  // the same for the lengths of boundaries

double component_min(double a, double b) { return a < b ? a : b; }
double component_max(double a, double b) { return a < b ? b : a; }

double area_of(std::span<const Triangle2> triangles) {
  double area = 0.0;
  for (const Triangle2& t : triangles) {
    area += 0.5 *
            std::abs((t[1].u - t[0].u) * (t[2].v - t[0].v) - (t[1].v - t[0].v) * (t[2].u - t[0].u));
  }
  return area;
}

double length_of(std::span<const Point2> polygon) {
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i];
    const Point2& q = polygon[(i + 1) % polygon.size()];
    length += std::hypot(q.u - p.u, q.v - p.v);
  }
  return length;
}

// True if an area is that of the convex outline, up to vertex errors of `straight` [m].
bool fills(double area, std::span<const Point2> hull, double straight) {
  double hull_area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point2& p = hull[i];
    const Point2& q = hull[(i + 1) % hull.size()];
    hull_area += 0.5 * (p.u * q.v - p.v * q.u);
  }
  return std::abs(hull_area - area) <= kAreaTolerance * hull_area + straight * length_of(hull);
}

// True if a boundary is no longer than the convex outline; an opening would make it longer.
bool is_outline(std::span<const Side> boundary, std::span<const Point2> hull) {
  const double outline = length_of(hull);
  double length = 0.0;
  for (const Side& side : boundary) {
    length += std::hypot(side.to.u - side.from.u, side.to.v - side.from.v);
  }
  return std::abs(length - outline) <= kLengthTolerance * outline;
}

}  // namespace

Surface::Surface(const Plane<double>& plane,
                 const std::vector<std::array<Vec3d, 3>>& triangles,
                 double rounding)
    : plane_(plane) {
  // The first edge of the first triangle is a good axis for rectangles: their edges become
  // parallel to u and v.
  const Vec3d along = triangles[0][1] - triangles[0][0];
  u_axis_ = unit_vector(along - dot(along, plane.normal) * plane.normal);
  v_axis_ = cross(plane.normal, u_axis_);
  const Vec3d& corner = triangles[0][0];
  origin_ = corner - distance(plane, corner) * plane.normal;

  double off_plane = 0.0;
  std::vector<Triangle2> flat;
  flat.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    flat.push_back({project(t[0]), project(t[1]), project(t[2])});
    for (const Vec3d& vertex : t) {
      off_plane = std::max(off_plane, std::abs(distance(plane, vertex)));
    }
  }
  // Vertices have the same error within the plane as across it.
  const double straight = std::max({kStraight, 2.0 * rounding, 2.0 * off_plane});
  flat = without_doubles(std::move(flat));
  std::vector<Point2> all;
  for (const Triangle2& t : flat) {
    all.insert(all.end(), t.begin(), t.end());
  }
  const std::vector<Point2> hull = convex_hull(std::move(all), straight);
  for (const Point2& p : hull) {
    outline_.push_back(lift(p));
  }
  // Seams between pieces, and to other faces, are as wide as the vertex error.
  const double seam = straight > kStraight ? straight : 0.0;
  area_ = area_of(flat);
  boundary_ = boundary_of(flat, straight);
  // If the outline is the whole boundary there are no openings, and no overlaps either.
  const bool is_filled = fills(area_, hull, straight) && is_outline(boundary_, hull);
  if (!is_filled) {
    flat = disjoint_triangles(flat, straight);
    area_ = area_of(flat);
    boundary_ = boundary_of(flat, straight);
  }
  if (is_filled || fills(area_, hull, straight)) {
    boundary_.clear();
    add_piece(hull, seam);
    return;
  }
  for (const Triangle2& t : flat) {
    add_piece(convex_hull({t[0], t[1], t[2]}, 0.0), seam);
  }
}

Point2 Surface::project(const Vec3d& point) const {
  const Vec3d from_origin = point - origin_;
  return {dot(u_axis_, from_origin), dot(v_axis_, from_origin)};
}

Vec3d Surface::lift(const Point2& point) const {
  return origin_ + point.u * u_axis_ + point.v * v_axis_;
}

void Surface::add_piece(const std::vector<Point2>& corners, double seam) {
  if (corners.size() < 3) {
    return;
  }
  Piece piece{static_cast<std::uint32_t>(edges_.size()),
              static_cast<std::uint32_t>(corners.size()),
              lift(corners[0]),
              lift(corners[0])};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2& p = corners[i];
    const Point2& q = corners[(i + 1) % corners.size()];
    const double length = std::hypot(q.u - p.u, q.v - p.v);
    const double a = -(q.v - p.v) / length;
    const double b = (q.u - p.u) / length;
    edges_.push_back({a, b, seam - (a * p.u + b * p.v)});
    const Vec3d corner = lift(p);
    piece.lower = {component_min(piece.lower.x, corner.x),
                   component_min(piece.lower.y, corner.y),
                   component_min(piece.lower.z, corner.z)};
    piece.upper = {component_max(piece.upper.x, corner.x),
                   component_max(piece.upper.y, corner.y),
                   component_max(piece.upper.z, corner.z)};
  }
  const Vec3d wider{seam, seam, seam};
  piece.lower = piece.lower - wider;
  piece.upper = piece.upper + wider;
  pieces_.push_back(piece);
}

}  // namespace rayloc
