#include "engine/trace/images/beam.h"

#include <algorithm>
#include <cstddef>

namespace rayloc {

bool is_outside(const Plane<double>& plane, std::span<const Vec3d> polygon) {
  return std::all_of(polygon.begin(), polygon.end(), [&](const Vec3d& corner) {
    return distance(plane, corner) < -kBeamMargin;
  });
}

// Sutherland and Hodgman, Commun. ACM 17 (1974) 32.
void clip(const Plane<double>& plane, Polygon& polygon, Polygon& scratch) {
  const auto inside = [&](const Vec3d& corner) { return distance(plane, corner) + kBeamMargin; };
  if (polygon.empty()) {
    return;
  }
  scratch.clear();
  bool is_cut = false;
  const Vec3d* p = &polygon.back();
  double dp = inside(*p);
  for (const Vec3d& q : polygon) {
    const double dq = inside(q);
    if ((dp >= 0.0) != (dq >= 0.0)) {
      scratch.push_back(*p + (dp / (dp - dq)) * (q - *p));
    }
    if (dq >= 0.0) {
      scratch.push_back(q);
    } else {
      is_cut = true;
    }
    p = &q;
    dp = dq;
  }
  if (is_cut) {
    polygon.swap(scratch);
  }
}

Polygon grown(std::span<const Vec3d> outline, const Vec3d& normal, double margin) {
  constexpr double kSharpest = 1e-3;  // 1 + cos of the turn at a corner, 2.6 degrees wide
  const std::size_t n = outline.size();
  Polygon result;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d before = cross(normalized(outline[i] - outline[(i + n - 1) % n]), normal);
    const Vec3d after = cross(normalized(outline[(i + 1) % n] - outline[i]), normal);
    const double turn = std::max(1.0 + dot(before, after), kSharpest);
    result.push_back(outline[i] + (margin / turn) * (before + after));
  }
  return result;
}

void beam_planes(std::span<const Vec3d> apexes,
                 double side,
                 std::span<const Vec3d> window,
                 std::vector<Plane<double>>& planes) {
  planes.clear();
  const double inwards = side > 0.0 ? -1.0 : 1.0;
  Vec3d from = window.back();
  for (const Vec3d& to : window) {
    // The plane through the side that has every apex on it or outside: the beams of the other
    // apexes stay inside of it.
    const Vec3d* apex = &apexes.front();
    Vec3d a = from - *apex;
    Vec3d b = to - *apex;
    Vec3d across = inwards * cross(a, b);
    for (const Vec3d& other : apexes.subspan(1)) {
      if (dot(across, other - *apex) > 0.0) {
        apex = &other;
        a = from - other;
        b = to - other;
        across = inwards * cross(a, b);
      }
    }
    const double square = dot(across, across);
    // Seen end on: the sum of the squares is at least half the square of |a| + |b|.
    if (square > 2.0 * kBeamMargin * kBeamMargin * (dot(a, a) + dot(b, b))) {
      const Vec3d normal = (1.0 / std::sqrt(square)) * across;
      planes.push_back({normal, dot(normal, *apex)});
    }
    from = to;
  }
}

}  // namespace rayloc
