#include "daemon/site/import/wall_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayloc {
namespace {

constexpr double kMaxParallelSine = 0.02;  // sine, chosen: one degree
constexpr double kSideBySide = 0.1;        // [m], chosen: shorter is at a corner of two walls

struct Interval {
  double begin = 0.0;  // [m] along a line
  double end = 0.0;
};

FloorPoint along(const WallLine& line, double at) {
  const double share = at / length_of(line);
  return {line.from[0] + share * (line.to[0] - line.from[0]),
          line.from[1] + share * (line.to[1] - line.from[1])};
}

// Coordinates of a point: distance along a line, and to its left [m].
std::pair<double, double> place_on_line(const WallLine& line, const FloorPoint& p) {
  const double length = length_of(line);
  const double ux = (line.to[0] - line.from[0]) / length;
  const double uy = (line.to[1] - line.from[1]) / length;
  const double x = p[0] - line.from[0];
  const double y = p[1] - line.from[1];
  return {ux * x + uy * y, ux * y - uy * x};
}

bool is_parallel(const WallLine& a, const WallLine& b) {
  const double cross =
      (a.to[0] - a.from[0]) * (b.to[1] - b.from[1]) - (a.to[1] - a.from[1]) * (b.to[0] - b.from[0]);
  return std::abs(cross) < kMaxParallelSine * length_of(a) * length_of(b);
}

// The interval of `line` that is beside `other`.
Interval beside(const WallLine& line, const WallLine& other) {
  const double from = place_on_line(line, other.from).first;
  const double to = place_on_line(line, other.to).first;
  return {std::max(0.0, std::min(from, to)), std::min(length_of(line), std::max(from, to))};
}

std::vector<Interval> without(const std::vector<Interval>& all, const Interval& taken) {
  std::vector<Interval> left;
  left.reserve(all.size() + 1);
  for (const Interval& one : all) {
    if (taken.end <= one.begin || taken.begin >= one.end) {
      left.push_back(one);
      continue;
    }
    if (taken.begin > one.begin) {
      left.push_back({one.begin, taken.begin});
    }
    if (taken.end < one.end) {
      left.push_back({taken.end, one.end});
    }
  }
  return left;
}

struct Pair {
  std::size_t one = 0;
  std::size_t other = 0;
  double apart = 0.0;  // [m], distance of `other` to the left of `one`
};

// Sorted by distance, nearest first.
std::vector<Pair> pairs_of(const std::vector<WallLine>& lines) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t j = i + 1; j < lines.size(); ++j) {
      if (!is_parallel(lines[i], lines[j])) {
        continue;
      }
      const Interval common = beside(lines[i], lines[j]);
      const double apart = 0.5 * (place_on_line(lines[i], lines[j].from).second +
                                  place_on_line(lines[i], lines[j].to).second);
      if (std::abs(apart) >= kThinnest && std::abs(apart) <= kThickest &&
          common.end - common.begin > kSideBySide) {
        pairs.push_back({i, j, apart});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::abs(a.apart) < std::abs(b.apart);
  });
  return pairs;
}

// Sine, chosen: 24 degrees, above the bend between two chords of a curve.
constexpr double kMaxBendSine = 0.4;
constexpr double kSamePlace = 1e-3;  // [m], chosen

// True if one bends into the other, as chords of a curve do.
bool is_bend(const WallLine& a, const WallLine& b) {
  const auto bends_at = [](const FloorPoint& at,
                           const FloorPoint& other_end,
                           const FloorPoint& own,
                           const FloorPoint& own_end) {
    if (std::hypot(at[0] - own[0], at[1] - own[1]) > kSamePlace) {
      return false;
    }
    const FloorPoint u{other_end[0] - at[0], other_end[1] - at[1]};
    const FloorPoint v{own_end[0] - own[0], own_end[1] - own[1]};
    return u[0] * v[0] + u[1] * v[1] < 0.0;
  };
  const bool is_joined =
      bends_at(a.to, a.from, b.from, b.to) || bends_at(a.from, a.to, b.to, b.from) ||
      bends_at(a.to, a.from, b.to, b.from) || bends_at(a.from, a.to, b.from, b.to);
  const double cross =
      (a.to[0] - a.from[0]) * (b.to[1] - b.from[1]) - (a.to[1] - a.from[1]) * (b.to[0] - b.from[0]);
  return is_joined && !is_parallel(a, b) &&
         std::abs(cross) < kMaxBendSine * length_of(a) * length_of(b);
}

// True for a chord of a curve. Other short lines close the end of a wall.
bool is_chord(const std::vector<WallLine>& lines, const WallLine& line) {
  return std::any_of(
      lines.begin(), lines.end(), [&](const WallLine& other) { return is_bend(line, other); });
}

}  // namespace

double length_of(const WallLine& line) {
  return std::hypot(line.to[0] - line.from[0], line.to[1] - line.from[1]);
}

std::vector<WallLine> wall_lines(const std::vector<WallLine>& drawn) {
  std::vector<WallLine> lines;
  std::copy_if(drawn.begin(), drawn.end(), std::back_inserter(lines), [](const WallLine& line) {
    return length_of(line) > 1e-6;
  });
  std::vector<std::vector<Interval>> left;  // by line, the parts not yet in a pair
  left.reserve(lines.size());
  for (const WallLine& line : lines) {
    left.push_back({{0.0, length_of(line)}});
  }
  std::vector<WallLine> walls;
  for (const Pair& pair : pairs_of(lines)) {
    const WallLine& one = lines[pair.one];
    const WallLine& other = lines[pair.other];
    const double half = 0.5 * pair.apart / length_of(one);
    const FloorPoint aside{-half * (one.to[1] - one.from[1]), half * (one.to[0] - one.from[0])};
    for (const Interval& free : std::vector<Interval>(left[pair.one])) {
      for (const Interval& opposite : std::vector<Interval>(left[pair.other])) {
        const Interval seen =
            beside(one, {along(other, opposite.begin), along(other, opposite.end), "", 0.0});
        const Interval common{std::max(free.begin, seen.begin), std::min(free.end, seen.end)};
        if (common.end - common.begin <= kSideBySide) {
          continue;
        }
        const FloorPoint from = along(one, common.begin);
        const FloorPoint to = along(one, common.end);
        walls.push_back({{from[0] + aside[0], from[1] + aside[1]},
                         {to[0] + aside[0], to[1] + aside[1]},
                         one.layer,
                         std::abs(pair.apart)});
        left[pair.one] = without(left[pair.one], common);
        const Interval taken = beside(other, {from, to, "", 0.0});
        left[pair.other] = without(left[pair.other], taken);
      }
    }
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (const Interval& one : left[i]) {
      const double length = one.end - one.begin;
      if (length > kThickest || (length == length_of(lines[i]) && is_chord(lines, lines[i]))) {
        walls.push_back(
            {along(lines[i], one.begin), along(lines[i], one.end), lines[i].layer, 0.0});
      }
    }
  }
  return walls;
}

std::vector<WallLine> cut_at(const std::vector<WallLine>& walls, const WallLine& opening) {
  std::vector<WallLine> left;
  left.reserve(walls.size());
  for (const WallLine& wall : walls) {
    const double apart =
        0.5 * (place_on_line(wall, opening.from).second + place_on_line(wall, opening.to).second);
    const Interval taken = beside(wall, opening);
    if (!is_parallel(wall, opening) || std::abs(apart) > kThickest || taken.begin >= taken.end) {
      left.push_back(wall);
      continue;
    }
    for (const Interval& one : without({{0.0, length_of(wall)}}, taken)) {
      left.push_back({along(wall, one.begin), along(wall, one.end), wall.layer, wall.thickness});
    }
  }
  return left;
}

}  // namespace rayloc
