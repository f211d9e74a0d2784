#include "engine/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <tuple>

#include "engine/scene/convex_hull.h"

namespace rayloc {
namespace {

using Triangle = std::array<Vec3d, 3>;

// Normals of coplanar triangles: cos(angle) at least this.
constexpr double kParallel = 1.0 - 5e-7;
// A corner nearer to the line between its neighbours than this is none [m]: more than the rounding
// of coordinates within kFarthest of the origin, less than kEdgeTolerance.
constexpr double kStraight = 1e-10;
// Relative difference of areas up to which pieces fill their convex outline.
constexpr double kAreaTolerance = 1e-7;

Vec3d twice_area_vector(const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); }

Vec3d unit(const Vec3d& v) {
  const double length = norm(v);
  return {v.x / length, v.y / length, v.z / length};  // exact for a vector along an axis
}

double component_min(double a, double b) { return a < b ? a : b; }
double component_max(double a, double b) { return a < b ? b : a; }

}  // namespace

Surface::Surface(const Plane<double>& plane, const std::vector<std::array<Vec3d, 3>>& triangles)
    : plane_(plane) {
  // The first edge of the first triangle is a good axis for rectangles: their edges become
  // parallel to u and v.
  const Vec3d along = triangles[0][1] - triangles[0][0];
  u_axis_ = unit(along - dot(along, plane.normal) * plane.normal);
  v_axis_ = cross(plane.normal, u_axis_);
  const Vec3d& corner = triangles[0][0];
  origin_ = corner - distance(plane, corner) * plane.normal;

  std::vector<Point2> all;
  double triangles_area = 0.0;
  for (const Triangle& t : triangles) {
    triangles_area += 0.5 * norm(twice_area_vector(t));
    for (const Vec3d& vertex : t) {
      all.push_back(project(vertex));
    }
  }
  area_ = triangles_area;

  const std::vector<Point2> hull = convex_hull(std::move(all), kStraight);
  double hull_area = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point2& p = hull[i];
    const Point2& q = hull[(i + 1) % hull.size()];
    hull_area += 0.5 * (p.u * q.v - p.v * q.u);
    outline_.push_back(lift(p));
  }
  if (std::abs(hull_area - triangles_area) <= kAreaTolerance * hull_area) {
    add_piece(hull);
    return;
  }
  for (const Triangle& t : triangles) {
    add_piece(convex_hull({project(t[0]), project(t[1]), project(t[2])}, 0.0));
  }
  find_boundary(triangles);
}

// Sides of triangles that no other triangle has: those that two share lie inside.
void Surface::find_boundary(const std::vector<std::array<Vec3d, 3>>& triangles) {
  std::map<std::array<double, 4>, int> uses;
  for (const Triangle& t : triangles) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      Point2 a = project(t[i]);
      Point2 b = project(t[(i + 1) % t.size()]);
      if (std::tie(b.u, b.v) < std::tie(a.u, a.v)) {
        std::swap(a, b);
      }
      ++uses[{a.u, a.v, b.u, b.v}];
    }
  }
  for (const auto& [side, count] : uses) {
    if (count == 1) {
      boundary_.push_back({{side[0], side[1]}, {side[2], side[3]}});
    }
  }
}

Point2 Surface::project(const Vec3d& point) const {
  const Vec3d from_origin = point - origin_;
  return {dot(u_axis_, from_origin), dot(v_axis_, from_origin)};
}

Vec3d Surface::lift(const Point2& point) const {
  return origin_ + point.u * u_axis_ + point.v * v_axis_;
}

void Surface::add_piece(const std::vector<Point2>& corners) {
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
    edges_.push_back({a, b, -(a * p.u + b * p.v)});
    const Vec3d corner = lift(p);
    piece.lower = {component_min(piece.lower.x, corner.x),
                   component_min(piece.lower.y, corner.y),
                   component_min(piece.lower.z, corner.z)};
    piece.upper = {component_max(piece.upper.x, corner.x),
                   component_max(piece.upper.y, corner.y),
                   component_max(piece.upper.z, corner.z)};
  }
  pieces_.push_back(piece);
}

std::vector<MeshSurface> planar_surfaces(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  }
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return norm(twice_area_vector(triangles[i])) > norm(twice_area_vector(triangles[j]));
  });

  struct Group {
    std::size_t first_triangle;  // lowest index
    Plane<double> plane;
    std::vector<Triangle> triangles;
    bool one_facing = true;
  };
  std::vector<Group> groups;
  for (const std::size_t i : order) {
    const Triangle& t = triangles[i];
    const Vec3d normal = unit(twice_area_vector(t));
    const auto fits = [&](const Group& group) {
      return std::abs(dot(group.plane.normal, normal)) >= kParallel &&
             std::all_of(t.begin(), t.end(), [&](const Vec3d& vertex) {
               return std::abs(distance(group.plane, vertex)) <= kCoplanarTolerance;
             });
    };
    auto group = std::find_if(groups.begin(), groups.end(), fits);
    if (group == groups.end()) {
      groups.push_back({i, {normal, dot(normal, t[0])}, {}, true});
      group = std::prev(groups.end());
    }
    group->first_triangle = std::min(group->first_triangle, i);
    group->triangles.push_back(t);
    group->one_facing = group->one_facing && dot(group->plane.normal, normal) > 0.0;
  }

  std::sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.first_triangle < b.first_triangle;
  });
  std::vector<MeshSurface> surfaces;
  surfaces.reserve(groups.size());
  for (const Group& group : groups) {
    surfaces.push_back({Surface(group.plane, group.triangles), group.one_facing});
  }
  return surfaces;
}

}  // namespace rayloc
