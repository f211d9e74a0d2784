#include "engine/base/outline.h"

#include <algorithm>
#include <cmath>

namespace rayloc {
namespace {

double cross(const FloorPoint& origin, const FloorPoint& a, const FloorPoint& b) {
  return (a[0] - origin[0]) * (b[1] - origin[1]) - (a[1] - origin[1]) * (b[0] - origin[0]);
}

bool within_box(const FloorPoint& a, const FloorPoint& b, const FloorPoint& p) {
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) &&
         std::min(a[1], b[1]) <= p[1] && p[1] <= std::max(a[1], b[1]);
}

// Sides of a and b relative to c-d, and of c and d relative to a-b; 0: on the line.
std::array<double, 4> sides(const FloorPoint& a,
                            const FloorPoint& b,
                            const FloorPoint& c,
                            const FloorPoint& d) {
  return {cross(c, d, a), cross(c, d, b), cross(a, b, c), cross(a, b, d)};
}

bool is_crossed(const std::array<double, 4>& s) {
  return (s[0] > 0) != (s[1] > 0) && (s[2] > 0) != (s[3] > 0) &&
         std::find(s.begin(), s.end(), 0.0) == s.end();
}

// True if the segments a-b and c-d have a point in common.
bool segments_touch(const FloorPoint& a,
                    const FloorPoint& b,
                    const FloorPoint& c,
                    const FloorPoint& d) {
  const auto s = sides(a, b, c, d);
  return is_crossed(s) || (s[0] == 0 && within_box(c, d, a)) ||
         (s[1] == 0 && within_box(c, d, b)) || (s[2] == 0 && within_box(a, b, c)) ||
         (s[3] == 0 && within_box(a, b, d));
}

}  // namespace

bool segments_cross(const FloorPoint& a,
                    const FloorPoint& b,
                    const FloorPoint& c,
                    const FloorPoint& d) {
  return is_crossed(sides(a, b, c, d));
}

std::size_t first_crossing(std::span<const FloorPoint> outline) {
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const bool neighbours = i == 0 && j + 1 == n;
      if (!neighbours &&
          segments_touch(outline[i], outline[i + 1], outline[j], outline[(j + 1) % n])) {
        return j;
      }
    }
  }
  return n;
}

double signed_area(std::span<const FloorPoint> outline) {
  double area = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    area += 0.5 * cross(outline[0], outline[i], outline[(i + 1) % outline.size()]);
  }
  return area;
}

FloorDistance distance_from_edge(const FloorPoint& from,
                                 const FloorPoint& to,
                                 const FloorPoint& p) {
  const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
  const double ahead = (to[0] - from[0]) * (p[0] - from[0]) + (to[1] - from[1]) * (p[1] - from[1]);
  const double along = length > 0.0 ? std::clamp(ahead / length, 0.0, length) : 0.0;
  const double share = length > 0.0 ? along / length : 0.0;
  return {std::hypot(p[0] - from[0] - share * (to[0] - from[0]),
                     p[1] - from[1] - share * (to[1] - from[1])),
          along};
}

bool is_within(std::span<const FloorPoint> outline, const FloorPoint& point, double margin) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const FloorPoint& a = outline[i];
    const FloorPoint& b = outline[(i + 1) % outline.size()];
    if (distance_from_edge(a, b, point).across <= margin) {
      return true;
    }
    if ((a[1] > point[1]) != (b[1] > point[1]) &&
        point[0] < a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
      inside = !inside;
    }
  }
  return inside;
}

}  // namespace rayloc
