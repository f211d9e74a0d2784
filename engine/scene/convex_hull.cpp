#include "engine/scene/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace rayloc {
namespace {

double distance2(const Point2& a, const Point2& b) {
  return (b.u - a.u) * (b.u - a.u) + (b.v - a.v) * (b.v - a.v);
}

// Andrew's monotone chain, Inf. Process. Lett. 9 (1979) 216.
std::vector<Point2> exact_hull(std::vector<Point2> points) {
  std::sort(points.begin(), points.end(), [](const Point2& a, const Point2& b) {
    return std::tie(a.u, a.v) < std::tie(b.u, b.v);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  std::vector<Point2> hull;
  const auto half = [&](auto begin, auto end) {
    const std::size_t start = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= start + 2 && orientation(hull[hull.size() - 2], hull.back(), *p) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();  // the first corner of the other half
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  return hull;
}

// The corner furthest from the middle: no line between others passes it.
std::vector<Point2>::iterator outermost(std::vector<Point2>& corners) {
  Point2 middle{0.0, 0.0};
  for (const Point2& p : corners) {
    middle.u += p.u / static_cast<double>(corners.size());
    middle.v += p.v / static_cast<double>(corners.size());
  }
  return std::max_element(corners.begin(), corners.end(), [&](const Point2& a, const Point2& b) {
    return distance2(a, middle) < distance2(b, middle);
  });
}

}  // namespace

std::vector<Point2> convex_hull(std::vector<Point2> points, double tolerance) {
  std::vector<Point2> corners = exact_hull(std::move(points));
  if (corners.size() < 3) {
    return corners;
  }
  std::rotate(corners.begin(), outermost(corners), corners.end());
  std::vector<Point2> kept{corners[0]};
  std::size_t anchor = 0;  // of the last corner kept
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Point2& from = corners[anchor];
    const Point2& to = corners[i + 1 == corners.size() ? 0 : i + 1];
    const double length = std::sqrt(distance2(from, to));
    // All corners that the line from the anchor would cut off, not only the newest: a circle of
    // many corners stays a circle.
    const bool is_straight =
        std::all_of(corners.begin() + static_cast<std::ptrdiff_t>(anchor) + 1,
                    corners.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                    [&](const Point2& p) {
                      const double twice_area =
                          (to.u - from.u) * (p.v - from.v) - (to.v - from.v) * (p.u - from.u);
                      return std::abs(twice_area) <= tolerance * length;
                    });
    if (!is_straight) {
      kept.push_back(corners[i]);
      anchor = i;
    }
  }
  return kept;
}

}  // namespace rayloc
