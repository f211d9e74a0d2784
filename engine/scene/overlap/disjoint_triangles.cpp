#include "engine/scene/overlap/disjoint_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "engine/scene/overlap/box_tree.h"

namespace rayloc {
namespace {

using Polygon = std::vector<Point2>;  // convex, anticlockwise

// Distance of a point from the line a, b; positive to its left [m].
double left_of(const Point2& a, const Point2& b, const Point2& p) {
  return ((b.u - a.u) * (p.v - a.v) - (b.v - a.v) * (p.u - a.u)) / std::hypot(b.u - a.u, b.v - a.v);
}

double furthest_left(const Point2& a, const Point2& b, std::span<const Point2> points) {
  double furthest = -std::numeric_limits<double>::infinity();
  for (const Point2& p : points) {
    furthest = std::max(furthest, left_of(a, b, p));
  }
  return furthest;
}

// True if a side of `a` has all of `b` on its outer side, up to the tolerance.
bool has_separating_side(std::span<const Point2> a, std::span<const Point2> b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Point2& from = a[i];
    const Point2& to = a[(i + 1) % a.size()];
    if (!(from == to) && furthest_left(from, to, b) <= tolerance) {
      return true;
    }
  }
  return false;
}

bool do_overlap(std::span<const Point2> a, std::span<const Point2> b, double tolerance) {
  return !has_separating_side(a, b, tolerance) && !has_separating_side(b, a, tolerance);
}

bool is_thin(std::span<const Point2> polygon, double tolerance) {
  return polygon.size() < 3 || has_separating_side(polygon, polygon, tolerance);
}

// The two parts of a polygon on the sides of the line from a to b: left, right.
std::pair<Polygon, Polygon> cut_along(const Polygon& polygon, const Point2& a, const Point2& b) {
  std::pair<Polygon, Polygon> parts;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point2& p = polygon[i];
    const Point2& q = polygon[(i + 1) % polygon.size()];
    const double at_p = left_of(a, b, p);
    const double at_q = left_of(a, b, q);
    if (at_p >= 0.0) {
      parts.first.push_back(p);
    }
    if (at_p <= 0.0) {
      parts.second.push_back(p);
    }
    if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) {
      const double share = at_p / (at_p - at_q);
      const Point2 crossing{p.u + share * (q.u - p.u), p.v + share * (q.v - p.v)};
      parts.first.push_back(crossing);
      parts.second.push_back(crossing);
    }
  }
  return parts;
}

// Appends the parts of `polygon` outside of `triangle`.
void append_outside(Polygon polygon,
                    const Triangle2& triangle,
                    double tolerance,
                    std::vector<Polygon>& parts) {
  if (!do_overlap(polygon, triangle, tolerance)) {
    parts.push_back(std::move(polygon));
    return;
  }
  for (std::size_t i = 0; i < triangle.size(); ++i) {
    auto [inner, outer] =
        cut_along(polygon, triangle.at(i), triangle.at((i + 1) % triangle.size()));
    if (!is_thin(outer, tolerance)) {
      parts.push_back(std::move(outer));
    }
    polygon = std::move(inner);
    if (is_thin(polygon, tolerance)) {
      return;
    }
  }
}

Triangle2 anticlockwise(const Triangle2& t) {
  return orientation(t[0], t[1], t[2]) < 0 ? Triangle2{t[0], t[2], t[1]} : t;
}

Box2 box_of(const Triangle2& t) {
  const auto [least_u, most_u] = std::minmax({t[0].u, t[1].u, t[2].u});
  const auto [least_v, most_v] = std::minmax({t[0].v, t[1].v, t[2].v});
  return {{least_u, least_v}, {most_u, most_v}};
}

// The parts of the first triangle that no other covers, as triangles.
std::vector<Triangle2> uncovered(const Triangle2& triangle,
                                 std::span<const Triangle2> others,
                                 double tolerance) {
  std::vector<Polygon> parts{Polygon(triangle.begin(), triangle.end())};
  for (const Triangle2& other : others) {
    std::vector<Polygon> rest;
    for (Polygon& part : parts) {
      append_outside(std::move(part), other, tolerance, rest);
    }
    parts = std::move(rest);
  }
  std::vector<Triangle2> triangles;
  for (const Polygon& part : parts) {
    for (std::size_t k = 2; k < part.size(); ++k) {
      const Triangle2 t{part[0], part[k - 1], part[k]};
      if (!is_thin(t, tolerance)) {
        triangles.push_back(t);
      }
    }
  }
  return triangles;
}

}  // namespace

std::vector<Triangle2> disjoint_triangles(std::span<const Triangle2> triangles, double tolerance) {
  std::vector<Triangle2> rotated;
  std::vector<Box2> boxes;
  for (const Triangle2& t : triangles) {
    rotated.push_back(anticlockwise(t));
    boxes.push_back(box_of(t));
  }
  const BoxTree tree(boxes);
  std::vector<Triangle2> result;
  for (std::size_t i = 0; i < rotated.size(); ++i) {
    std::vector<Triangle2> covering;
    for (const std::size_t k : tree.meeting(boxes[i])) {
      // A thin one covers no area, and its sides give no direction to cut along.
      if (k < i && do_overlap(rotated[i], rotated[k], tolerance) &&
          !is_thin(rotated[k], tolerance)) {
        covering.push_back(rotated[k]);
      }
    }
    if (covering.empty()) {
      result.push_back(triangles[i]);
      continue;
    }
    const std::vector<Triangle2> rest = uncovered(rotated[i], covering, tolerance);
    result.insert(result.end(), rest.begin(), rest.end());
  }
  return result;
}

}  // namespace rayloc
