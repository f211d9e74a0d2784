// Triangulates a wall: an upright sheet with openings, below a ceiling of any slope.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "daemon/site/scene/plan_rooms.h"

namespace rayloc {
namespace {

// Cuts closer together than this are merged; a triangle between them would be degenerate.
constexpr double kSameCut = 1e-5;  // [m]

std::vector<double> cuts(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto same = [](double a, double b) { return b - a < kSameCut; };
  values.erase(std::unique(values.begin(), values.end(), same), values.end());
  return values;
}

bool is_open(std::span<const PlanHole> holes, double u, double v) {
  return std::any_of(holes.begin(), holes.end(), [&](const PlanHole& hole) {
    return u > hole.lower[0] && u < hole.upper[0] && v > hole.lower[1] && v < hole.upper[1];
  });
}

// The edge's heights at `left` and `right`, between which it is straight.
std::pair<double, double> heights(std::span<const FloorPoint> top, double left, double right) {
  const double middle = 0.5 * (left + right);
  std::size_t i = 0;
  while (i + 2 < top.size() && top[i + 1][0] <= middle) {
    ++i;
  }
  const auto [u0, v0] = top[i];
  const auto [u1, v1] = top[i + 1];
  const double slope = v0 == v1 ? 0.0 : (v1 - v0) / (u1 - u0);
  return {v0 + slope * (left - u0), v0 + slope * (right - u0)};
}

// The cuts of the sheet along u: at its ends, at holes, at bends
// of the edge and where the edge crosses one of the heights.
std::vector<double> upright_cuts(std::span<const FloorPoint> top,
                                 std::span<const PlanHole> holes,
                                 std::span<const double> levels) {
  const double first = top.front()[0];
  const double last = top.back()[0];
  std::vector<double> values;
  for (std::size_t i = 0; i < top.size(); ++i) {
    values.push_back(top[i][0]);
    if (i + 1 == top.size() || top[i][1] == top[i + 1][1]) {
      continue;
    }
    for (const double level : levels) {
      const double share = (level - top[i][1]) / (top[i + 1][1] - top[i][1]);
      if (share > 0.0 && share < 1.0) {
        values.push_back(top[i][0] + share * (top[i + 1][0] - top[i][0]));
      }
    }
  }
  for (const PlanHole& hole : holes) {
    values.insert(values.end(),
                  {std::clamp(hole.lower[0], first, last), std::clamp(hole.upper[0], first, last)});
  }
  return cuts(std::move(values));
}

class SheetMesher {
 public:
  explicit SheetMesher(const SheetFrame& frame) : frame_(frame) {}

  // The part of a strip from height `low` to `left` at one side and to `right` at the other.
  void add(std::array<double, 2> u, double low, double left, double right) {
    std::vector<std::uint32_t> corners{corner(u[0], low)};
    const auto right_side = [&] { corners.push_back(corner(u[1], low)); };
    const auto tops = [&] {
      if (right - low >= kSameCut) {
        corners.push_back(corner(u[1], right));
      }
    };
    if (frame_.flipped) {
      if (left - low >= kSameCut) {
        corners.push_back(corner(u[0], left));
      }
      tops();
      right_side();
    } else {
      right_side();
      tops();
      if (left - low >= kSameCut) {
        corners.push_back(corner(u[0], left));
      }
    }
    for (std::size_t i = 2; i < corners.size(); ++i) {
      mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  }
  Mesh finish() { return std::move(mesh_); }

 private:
  std::uint32_t corner(double u, double v) {
    const auto next = static_cast<std::uint32_t>(mesh_.vertices.size());
    const auto [found, added] = corners_.try_emplace({u, v}, next);
    if (added) {
      mesh_.vertices.push_back(frame_.origin + u * frame_.u_axis + v * frame_.v_axis);
    }
    return found->second;
  }

  const SheetFrame& frame_;
  Mesh mesh_;
  std::map<std::pair<double, double>, std::uint32_t> corners_;
};

}  // namespace

Mesh sheet_mesh(const SheetFrame& frame,
                double bottom,
                std::span<const FloorPoint> top,
                std::span<const PlanHole> holes) {
  std::vector<double> levels{bottom};
  double highest = bottom;
  for (const FloorPoint& bend : top) {
    highest = std::max(highest, bend[1]);
    levels.push_back(bend[1]);
  }
  for (const PlanHole& hole : holes) {
    for (const double level : {hole.lower[1], hole.upper[1]}) {
      levels.push_back(std::clamp(level, bottom, highest));
    }
  }
  const std::vector<double> v = cuts(std::move(levels));
  const std::vector<double> u = upright_cuts(top, holes, v);

  SheetMesher mesher(frame);
  for (std::size_t i = 0; i + 1 < u.size(); ++i) {
    const auto [left_top, right_top] = heights(top, u[i], u[i + 1]);
    for (std::size_t j = 0; j + 1 < v.size(); ++j) {
      const auto up_to = [&](double edge) {  // merged cuts have one height
        return edge > v[j + 1] - kSameCut ? v[j + 1] : edge;
      };
      const double left = up_to(left_top);
      const double right = up_to(right_top);
      if (std::max(left, right) - v[j] < kSameCut ||
          is_open(holes, 0.5 * (u[i] + u[i + 1]), 0.5 * (v[j] + 0.5 * (left + right)))) {
        continue;
      }
      mesher.add({u[i], u[i + 1]}, v[j], left, right);
    }
  }
  return mesher.finish();
}

}  // namespace rayloc
