// Surface: all the coplanar triangles of one object, which together are one mirror.
//
// A surface has a plane and an outline, and tests whether a point of the plane lies on it. It need
// not be convex nor connected and may have holes: it is a list of convex pieces (one when the whole
// is convex, else its triangles).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/boundary.h"
#include "engine/scene/mesh.h"
#include "engine/scene/orientation.h"

namespace rayloc {

// Points x with dot(normal, x) = offset; norm(normal) = 1.
template <typename T>
struct Plane {
  Vec3<T> normal;
  T offset{};
};

// Signed distance of a point, positive on the side of the normal.
template <typename T>
T distance(const Plane<T>& plane, const Vec3<T>& point) {
  return dot(plane.normal, point) - plane.offset;
}

// Distance outside an edge at which a point still counts as on the surface [m]; closes the seam
// between two pieces, where rounding could let a ray through.
inline constexpr double kEdgeTolerance = 1e-9;

class Surface {
 public:
  // Edge of a convex piece, in the plane coordinates (u, v): a u + b v + c is the distance from the
  // edge [m], positive inside.
  struct Edge {
    double a, b, c;
  };
  struct Piece {
    std::uint32_t first_edge;
    std::uint32_t edge_count;
    Vec3d lower;  // bounds, world
    Vec3d upper;
  };

  // `rounding`: position error of vertices [m]; edges and areas that are straight or
  // complete within it are treated as such. REQUIRES: triangles are not degenerate and lie
  // in `plane` up to rounding.
  Surface(const Plane<double>& plane,
          const std::vector<std::array<Vec3d, 3>>& triangles,
          double rounding = 0.0);

  const Plane<double>& plane() const { return plane_; }
  // Corners of the convex outline, anticlockwise as seen from the side of the normal.
  const std::vector<Vec3d>& outline() const { return outline_; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  double area() const { return area_; }  // [m^2], for a sheet of two faces that of one

  // Axes and origin of the plane coordinates, world.
  const Vec3d& origin() const { return origin_; }
  const Vec3d& u_axis() const { return u_axis_; }
  const Vec3d& v_axis() const { return v_axis_; }
  std::span<const Edge> edges(const Piece& piece) const {
    return std::span(edges_).subspan(piece.first_edge, piece.edge_count);
  }

  bool is_convex() const { return pieces_.size() == 1; }
  // Distance of a point of the plane from the boundary [m], positive inside. Not smooth where two
  // parts of the boundary are equally near.
  template <typename T>
  T inside_distance(const T& u, const T& v) const;

  // True if a point of the plane lies on the surface, or no further than `margin` [m] outside the
  // edges of one of its pieces.
  bool contains(const Vec3d& point, double margin = 0.0) const {
    for (const Piece& piece : pieces_) {
      if (contains(piece, point, margin)) {
        return true;
      }
    }
    return false;
  }
  bool contains(const Piece& piece, const Vec3d& point, double margin = 0.0) const {
    const Vec3d from_origin = point - origin_;
    const double u = dot(u_axis_, from_origin);
    const double v = dot(v_axis_, from_origin);
    const double outside = -kEdgeTolerance - margin;
    for (std::uint32_t i = 0; i < piece.edge_count; ++i) {
      const Edge& edge = edges_[piece.first_edge + i];
      if (edge.a * u + edge.b * v + edge.c < outside) {
        return false;
      }
    }
    return true;
  }

 private:
  Point2 project(const Vec3d& point) const;
  // Adds a piece with its edges moved outwards by `seam` [m].
  void add_piece(const std::vector<Point2>& corners, double seam);
  Vec3d lift(const Point2& point) const;

  Plane<double> plane_;
  Vec3d origin_;  // a point of the plane amid the surface: keeps (u, v) small
  Vec3d u_axis_;
  Vec3d v_axis_;
  double area_ = 0.0;
  std::vector<Vec3d> outline_;
  std::vector<Edge> edges_;
  std::vector<Piece> pieces_;
  std::vector<Side> boundary_;
};

template <typename T>
T Surface::inside_distance(const T& u, const T& v) const {
  using std::sqrt;
  T least2(std::numeric_limits<double>::infinity());
  for (const Side& side : boundary_) {
    const double along_u = side.to.u - side.from.u;
    const double along_v = side.to.v - side.from.v;
    const T from_u = u - T(side.from.u);
    const T from_v = v - T(side.from.v);
    T share =
        (T(along_u) * from_u + T(along_v) * from_v) / T(along_u * along_u + along_v * along_v);
    if (share < T(0)) {
      share = T(0);
    } else if (share > T(1)) {
      share = T(1);
    }
    const T off_u = from_u - share * T(along_u);
    const T off_v = from_v - share * T(along_v);
    const T distance2 = off_u * off_u + off_v * off_v;
    if (distance2 < least2) {
      least2 = distance2;
    }
  }
  const T distance = least2 > T(0) ? T(sqrt(least2)) : T(0);
  bool inside = false;
  for (const Piece& piece : pieces_) {
    bool within = true;
    for (const Edge& edge : edges(piece)) {
      within = within && !(T(edge.a) * u + T(edge.b) * v + T(edge.c) < T(-kEdgeTolerance));
    }
    inside = inside || within;
  }
  return inside ? distance : -distance;
}

// The surfaces of one mesh, in the order of their first triangles, so that their numbers do not
// change when faces are moved. REQUIRES: finite vertices, valid indices, no degenerate triangle.
//
// Coplanar: all corners within `kCoplanarTolerance`, or a few roundings of the mesh where these are
// more, of the plane through all, and normals parallel within about 0.06 degrees or the tilt of a
// triangle of that height by rounding. So the result does not depend on the rotation and position
// of a wall, on its triangulation, or on the winding of a triangle.
struct MeshSurface {
  Surface surface;
  bool one_facing = false;  // every triangle faces the side of the plane's normal
};
inline constexpr double kCoplanarTolerance = 1e-5;  // [m]
inline double coplanar_tolerance(const Mesh& mesh) {
  // A ratio, chosen: a few roundings of the mesh.
  constexpr double kRoundings = 4.0;
  return std::max(kCoplanarTolerance, kRoundings * mesh.rounding);
}
std::vector<MeshSurface> planar_surfaces(const Mesh& mesh);

}  // namespace rayloc
