#include "engine/scene/read/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/scene/orientation.h"

namespace rayloc {
namespace {

// A face narrower than this in all places has no area [m].
constexpr double kMinWidth = 1e-6;
// A corner that rounding has moved across a line by this much is on the line [m].
constexpr double kOnLine = 1e-9;

// The last part of every error message for a face.
const std::string kAdvice = "; cut the face into triangles in the program that made it";

// Newell's formula: for a plane face, twice its area along its normal; relative to the first
// corner, so that no precision is lost far from the origin.
Vec3d twice_area_vector(std::span<const std::uint32_t> corners, const Mesh& mesh) {
  const Vec3d& first = mesh.vertices[corners[0]];
  Vec3d sum;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    sum = sum + cross(mesh.vertices[corners[i - 1]] - first, mesh.vertices[corners[i]] - first);
  }
  return sum;
}

bool has_no_area(std::span<const std::uint32_t> corners, const Mesh& mesh) {
  const Vec3d& first = mesh.vertices[corners[0]];
  Vec3d along;
  for (const std::uint32_t corner : corners) {
    const Vec3d away = mesh.vertices[corner] - first;
    along = norm(away) > norm(along) ? away : along;
  }
  const double length = norm(along);
  return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
    return norm(cross(along, mesh.vertices[corner] - first)) <= kMinWidth * length;
  });
}

// The corners in the plane of the face, in anticlockwise order.
std::vector<Point2> flattened(std::span<const std::uint32_t> corners,
                              const Mesh& mesh,
                              const Vec3d& normal) {
  const Vec3d& origin = mesh.vertices[corners[0]];
  // The world axis most nearly in the plane gives u: walls and floors keep round numbers.
  const std::array<Vec3d, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const Vec3d& across =
      *std::min_element(axes.begin(), axes.end(), [&](const auto& a, const auto& b) {
        return std::abs(dot(a, normal)) < std::abs(dot(b, normal));
      });
  const Vec3d u_axis = normalized(across - dot(across, normal) * normal);
  const Vec3d v_axis = cross(normal, u_axis);
  std::vector<Point2> points;
  points.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Vec3d away = mesh.vertices[corner] - origin;
    points.push_back({dot(u_axis, away), dot(v_axis, away)});
  }
  return points;
}

// Signed distance of a point from the line through two others [m], positive on the left.
double distance_from_line(const Point2& a, const Point2& b, const Point2& p) {
  const double length = std::hypot(b.u - a.u, b.v - a.v);
  return length > 0.0 ? ((b.u - a.u) * (p.v - a.v) - (b.v - a.v) * (p.u - a.u)) / length
                      : std::hypot(p.u - a.u, p.v - a.v);
}

// Every corner turns left, and the total turn is one revolution.
bool is_strictly_convex(std::span<const Point2> points) {
  int rounds = 0;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2& a = points[i];
    const Point2& b = points[(i + 1) % n];
    const Point2& c = points[(i + 2) % n];
    if (distance_from_line(a, c, b) >= -kOnLine) {
      return false;
    }
    // One revolution passes the lowest point once.
    rounds += (b.v < a.v || (b.v == a.v && b.u < a.u)) && (c.v > b.v || (c.v == b.v && c.u > b.u))
                  ? 1
                  : 0;
  }
  return rounds == 1;
}

bool lie_apart(double x, double y) {
  return (x > kOnLine && y < -kOnLine) || (x < -kOnLine && y > kOnLine);
}

bool cross_each_other(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  return lie_apart(distance_from_line(a, b, c), distance_from_line(a, b, d)) &&
         lie_apart(distance_from_line(c, d, a), distance_from_line(c, d, b));
}

// Number of times the outline winds round the point.
double winding(std::span<const Point2> points, const Point2& at) {
  double angle = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point2 a{points[i].u - at.u, points[i].v - at.v};
    const Point2& next = points[(i + 1) % points.size()];
    const Point2 b{next.u - at.u, next.v - at.v};
    angle += std::atan2(a.u * b.v - a.v * b.u, a.u * b.u + a.v * b.v);
  }
  return angle / (2.0 * std::numbers::pi);
}

Expected<void> check_outline(std::span<const Point2> points) {
  const std::size_t n = points.size();
  const auto edge = [&](std::size_t i) {
    return std::to_string(i + 1) + " to " + std::to_string((i + 1) % n + 1);
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (cross_each_other(points[i], points[(i + 1) % n], points[j], points[(j + 1) % n])) {
        return bad_input("its edges from corner " + edge(i) + " and from " + edge(j) +
                         " cross each other" + kAdvice);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Point2& a = points[i];
    const Point2& b = points[(i + 1) % n];
    const double length = std::hypot(b.u - a.u, b.v - a.v);
    if (length <= kOnLine) {
      continue;
    }
    const double left = kOnLine / length;
    const Point2 beside{0.5 * (a.u + b.u) - left * (b.v - a.v),
                        0.5 * (a.v + b.v) + left * (b.u - a.u)};
    if (winding(points, beside) > 1.5) {
      return bad_input("it covers what is beside its edge from corner " + edge(i) +
                       " twice; a hole must run the other way round than the outline" + kAdvice);
    }
  }
  return {};
}

// Cuts off ears: corners whose triangle contains no other corner. For any triangles cut off, the
// outline winds round a point as often as the point lies in triangles, minus the remaining outline;
// so when all of them have the correct winding and nothing is left, they cover exactly the face.
class EarClipper {
 public:
  explicit EarClipper(std::span<const Point2> points) : points_(points) {
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      ring_.push_back(i);
    }
  }

  // Triangles of indices into the points; false when the outline crosses itself.
  bool clip(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    while (ring_.size() > 2) {
      if (const std::size_t ear = find([&](std::size_t i) { return is_ear(i, true); });
          ear < ring_.size()) {
        cut(ear, &triangles);
      } else if (const std::size_t flat = find([&](std::size_t i) { return is_flat(i); });
                 flat < ring_.size()) {
        cut(flat, nullptr);
      } else if (const std::size_t touched = find([&](std::size_t i) { return is_ear(i, false); });
                 touched < ring_.size()) {
        cut(touched, &triangles);
      } else {
        return false;
      }
    }
    return true;
  }

 private:
  const Point2& point(std::size_t i) const { return points_[ring_[i % ring_.size()]]; }

  // The first wanted corner after the newest cut; ring_.size(): none.
  template <typename Wanted>
  std::size_t find(const Wanted& is_wanted) const {
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      const std::size_t i = (next_ + k) % ring_.size();
      if (is_wanted(i)) {
        return i;
      }
    }
    return ring_.size();
  }

  // True if ring_[i] can be cut off: no other corner is within the triangle nor, if `strictly`, on
  // one of the two edges that are removed.
  bool is_ear(std::size_t i, bool strictly) const {
    const Point2& a = point(i + ring_.size() - 1);
    const Point2& b = point(i);
    const Point2& c = point(i + 1);
    if (orientation(a, b, c) <= 0 || std::abs(distance_from_line(a, c, b)) <= kOnLine) {
      return false;
    }
    const double u_min = std::min({a.u, b.u, c.u});
    const double u_max = std::max({a.u, b.u, c.u});
    return std::none_of(ring_.begin(), ring_.end(), [&](std::uint32_t corner) {
      const Point2& p = points_[corner];
      if (p.u < u_min || p.u > u_max || p == a || p == b || p == c) {
        return false;
      }
      const int first = orientation(a, b, p);
      const int second = orientation(b, c, p);
      return orientation(c, a, p) >= 0 &&
             (strictly ? first >= 0 && second >= 0 : first > 0 && second > 0);
    });
  }

  // A corner on the line between its neighbours, or where the outline reverses.
  bool is_flat(std::size_t i) const {
    const Point2& a = point(i + ring_.size() - 1);
    const Point2& b = point(i);
    const Point2& c = point(i + 1);
    return a == b || b == c || a == c || std::abs(distance_from_line(a, c, b)) <= kOnLine;
  }

  void cut(std::size_t i, std::vector<std::array<std::uint32_t, 3>>* triangles) {
    const std::size_t n = ring_.size();
    if (triangles != nullptr) {
      triangles->push_back({ring_[(i + n - 1) % n], ring_[i], ring_[(i + 1) % n]});
    }
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(i));
    next_ = i % ring_.size();
  }

  std::span<const Point2> points_;
  std::vector<std::uint32_t> ring_;
  std::size_t next_ = 0;
};

void append_fan(std::span<const std::uint32_t> corners, Mesh& mesh) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

}  // namespace

Expected<void> append_triangles(std::span<const std::uint32_t> corners, Mesh& mesh) {
  if (corners.size() > kMaxCorners) {
    return bad_input("it has " + std::to_string(corners.size()) + " corners, " +
                     std::to_string(kMaxCorners) + " are read" + kAdvice);
  }
  if (corners.empty()) {
    return {};
  }
  if (corners.size() < 3) {
    mesh.triangles.push_back({corners.front(), corners.back(), corners.front()});
    return {};
  }
  if (corners.size() == 3 || has_no_area(corners, mesh)) {
    append_fan(corners, mesh);
    return {};
  }
  const Vec3d twice_area = twice_area_vector(corners, mesh);
  const double size = norm(twice_area);
  if (!(size > kMinWidth * kMinWidth)) {
    return bad_input("its edges cross each other: parts of it lie either way round" + kAdvice);
  }
  const std::vector<Point2> points = flattened(corners, mesh, (1.0 / size) * twice_area);
  if (is_strictly_convex(points)) {
    append_fan(corners, mesh);
    return {};
  }
  RAYLOC_TRY(check_outline(points));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (!EarClipper(points).clip(triangles)) {
    return bad_input("its edges cross or touch each other so that it has no inside" + kAdvice);
  }
  for (const auto& [a, b, c] : triangles) {
    mesh.triangles.push_back({corners[a], corners[b], corners[c]});
  }
  return {};
}

}  // namespace rayloc
