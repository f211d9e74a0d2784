#include "engine/scene/boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace rayloc {
namespace {

bool comes_before(const Point2& a, const Point2& b) {
  return std::tie(a.u, a.v) < std::tie(b.u, b.v);
}

// Numbers positions; points nearer to each other than the tolerance are one.
class Places {
 public:
  explicit Places(double tolerance) : tolerance_(tolerance) {}

  std::uint32_t number_of(const Point2& p) {
    // The grid is wider than the tolerance, so a neighbour is in one of nine cells.
    const double cell = 4.0 * tolerance_;
    const auto u = static_cast<std::int64_t>(std::floor(p.u / cell));
    const auto v = static_cast<std::int64_t>(std::floor(p.v / cell));
    for (std::int64_t i = u - 1; i <= u + 1; ++i) {
      for (std::int64_t j = v - 1; j <= v + 1; ++j) {
        const auto found = cells_.find({i, j});
        if (found != cells_.end() && std::hypot(points_[found->second].u - p.u,
                                                points_[found->second].v - p.v) <= tolerance_) {
          return found->second;
        }
      }
    }
    points_.push_back(p);
    const auto number = static_cast<std::uint32_t>(points_.size() - 1);
    cells_[{u, v}] = number;
    return number;
  }
  const Point2& operator[](std::uint32_t number) const { return points_[number]; }

 private:
  double tolerance_;
  std::vector<Point2> points_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> cells_;
};

// Directed sides; a triangle lies to their left.
class Sides {
 public:
  void add(std::uint32_t from, std::uint32_t to) {
    if (from != to) {
      directions_[{std::min(from, to), std::max(from, to)}] |= from < to ? 1U : 2U;
    }
  }
  // Sides with a triangle on one side only.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open() const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (const auto& [ends, directions] : directions_) {
      if (directions != 3U) {
        sides.push_back(directions == 1U ? ends : std::pair{ends.second, ends.first});
      }
    }
    return sides;
  }

 private:
  std::map<std::pair<std::uint32_t, std::uint32_t>, unsigned> directions_;
};

// The places that lie on the side from a to b, between its ends, in order. `places`: sorted.
std::vector<std::uint32_t> on_side(const Point2& a,
                                   const Point2& b,
                                   std::span<const std::pair<Point2, std::uint32_t>> places,
                                   double tolerance) {
  const double length = std::hypot(b.u - a.u, b.v - a.v);
  const auto begin = std::lower_bound(
      places.begin(), places.end(), std::min(a.u, b.u) - tolerance, [](const auto& p, double u) {
        return p.first.u < u;
      });
  std::vector<std::pair<double, std::uint32_t>> met;
  for (auto p = begin; p != places.end() && p->first.u <= std::max(a.u, b.u) + tolerance; ++p) {
    const double du = p->first.u - a.u;
    const double dv = p->first.v - a.v;
    const double along = ((b.u - a.u) * du + (b.v - a.v) * dv) / length;
    const double across = ((b.u - a.u) * dv - (b.v - a.v) * du) / length;
    if (std::abs(across) <= tolerance && along > tolerance && along < length - tolerance) {
      met.emplace_back(along, p->second);
    }
  }
  std::sort(met.begin(), met.end());
  std::vector<std::uint32_t> numbers;
  numbers.reserve(met.size());
  for (const auto& [along, number] : met) {
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace

std::vector<Triangle2> without_doubles(std::vector<Triangle2> triangles) {
  std::map<std::array<double, 6>, bool> known;
  std::erase_if(triangles, [&](const Triangle2& t) {
    Triangle2 sorted = t;
    std::sort(sorted.begin(), sorted.end(), comes_before);
    return !known
                .try_emplace(
                    {sorted[0].u, sorted[0].v, sorted[1].u, sorted[1].v, sorted[2].u, sorted[2].v},
                    true)
                .second;
  });
  return triangles;
}

std::vector<Side> boundary_of(std::span<const Triangle2> triangles, double tolerance) {
  Places places(tolerance);
  Sides whole;
  for (const Triangle2& t : triangles) {
    const bool is_left = orientation(t[0], t[1], t[2]) > 0;
    const std::array<std::uint32_t, 3> n{places.number_of(t[0]),
                                         places.number_of(t[is_left ? 1 : 2]),
                                         places.number_of(t[is_left ? 2 : 1])};
    for (std::size_t i = 0; i < n.size(); ++i) {
      whole.add(n.at(i), n.at((i + 1) % n.size()));
    }
  }
  // After cuts at the corners of others on them, sides are equal or do not touch.
  const auto open = whole.open();
  std::vector<std::pair<Point2, std::uint32_t>> ends;
  for (const auto& [from, to] : open) {
    ends.emplace_back(places[from], from);
    ends.emplace_back(places[to], to);
  }
  std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first.u, a.first.v, a.second) < std::tie(b.first.u, b.first.v, b.second);
  });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  Sides parts;
  for (const auto& [from, to] : open) {
    std::uint32_t last = from;
    for (const std::uint32_t next : on_side(places[from], places[to], ends, tolerance)) {
      parts.add(last, next);
      last = next;
    }
    parts.add(last, to);
  }
  std::vector<Side> sides;
  for (const auto& [from, to] : parts.open()) {
    sides.push_back({places[from], places[to]});
  }
  return sides;
}

}  // namespace rayloc
