#include "daemon/site/scene/plan_rooms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "engine/base/check.h"
#include "engine/scene/read/triangulate.h"

namespace rayloc {
namespace {

constexpr double kShortestWall = 1e-3;  // [m]; shorter ones are typing errors
constexpr double kMinRoomArea = 1e-2;   // [m^2]; the same for a room
// Walls of two rooms with at most this distance everywhere
// are one wall [m]: corners are written to the millimetre.
constexpr double kSameWall = 1e-3;
constexpr double kMinPiece = 1e-10;  // [m^2]; smaller is rounding

double distance(const FloorPoint& a, const FloorPoint& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

std::string corner_text(const FloorPoint& p) {
  return fmt::format("{}, {}", std::round(p[0] * 1e3) / 1e3, std::round(p[1] * 1e3) / 1e3);
}

// The flat ceiling and the slopes, of which the lowest applies.
std::vector<PlanSlope> planes_of(const PlanRoom& room, double highest) {
  std::vector<PlanSlope> planes{{0.0, 0.0, std::min(room.height, highest)}};
  planes.insert(planes.end(), room.slopes.begin(), room.slopes.end());
  return planes;
}

double lowest_of(std::span<const PlanSlope> planes, const FloorPoint& p) {
  double lowest = planes[0].at(p);
  for (const PlanSlope& plane : planes.subspan(1)) {
    lowest = std::min(lowest, plane.at(p));
  }
  return lowest;
}

double height_at(std::span<const FloorPoint> top, std::size_t piece, double along) {
  const auto [u0, v0] = top[piece];
  const auto [u1, v1] = top[piece + 1];
  return u1 > u0 ? v0 + (v1 - v0) / (u1 - u0) * (along - u0) : v0;
}

// The piece of the edge that contains `along`.
std::size_t piece_at(std::span<const FloorPoint> top, double along) {
  std::size_t i = 0;
  while (i + 2 < top.size() && top[i + 1][0] <= along) {
    ++i;
  }
  return i;
}

// The higher of two edges; `other` counts only within its extent.
std::vector<FloorPoint> higher_of(const std::vector<FloorPoint>& edge,
                                  const std::vector<FloorPoint>& other) {
  std::vector<double> bends;
  for (const auto* each : {&edge, &other}) {
    for (const FloorPoint& point : *each) {
      bends.push_back(std::clamp(point[0], edge.front()[0], edge.back()[0]));
    }
  }
  std::sort(bends.begin(), bends.end());
  std::vector<FloorPoint> result;
  const auto add = [&](double u, double v) {
    if (result.empty() || distance(result.back(), {u, v}) > kSameWall) {
      result.push_back({u, v});
    }
  };
  for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
    const double left = bends[i];
    const double right = bends[i + 1];
    const double middle = 0.5 * (left + right);
    if (right - left < 1e-9) {
      continue;
    }
    const std::size_t own = piece_at(edge, middle);
    std::array<double, 2> at{height_at(edge, own, left), height_at(edge, own, right)};
    if (middle > other.front()[0] && middle < other.back()[0]) {
      const std::size_t piece = piece_at(other, middle);
      const std::array<double, 2> above{height_at(other, piece, left) - at[0],
                                        height_at(other, piece, right) - at[1]};
      add(left, at[0] + std::max(above[0], 0.0));
      if ((above[0] > 0.0) != (above[1] > 0.0) && above[0] != above[1]) {
        const double cross = left + above[0] / (above[0] - above[1]) * (right - left);
        add(cross, height_at(edge, own, cross));
      }
      add(right, at[1] + std::max(above[1], 0.0));
    } else {
      add(left, at[0]);
      add(right, at[1]);
    }
  }
  return result;
}

struct Stretch {
  double from, to;  // [m], along a wall
  double begin;     // [m], begin of the wall, measured along the other one
  bool backwards;   // the other one has the opposite direction
};

// The stretch of `wall` that coincides with `other`.
std::optional<Stretch> shared(const PlanWall& wall, const PlanWall& other) {
  const double length = wall.length();
  const FloorPoint axis{(wall.to[0] - wall.from[0]) / length, (wall.to[1] - wall.from[1]) / length};
  std::array<double, 2> along{};
  const std::array<FloorPoint, 2> ends{other.from, other.to};
  for (std::size_t i = 0; i < 2; ++i) {
    const FloorPoint away{ends.at(i)[0] - wall.from[0], ends.at(i)[1] - wall.from[1]};
    if (std::abs(axis[0] * away[1] - axis[1] * away[0]) > kSameWall) {
      return std::nullopt;
    }
    along.at(i) = axis[0] * away[0] + axis[1] * away[1];
  }
  const double from = std::max(0.0, std::min(along[0], along[1]));
  const double to = std::min(length, std::max(along[0], along[1]));
  const bool backwards = along[1] < along[0];
  return to - from > kSameWall
             ? std::optional(Stretch{from, to, backwards ? along[0] : -along[0], backwards})
             : std::nullopt;
}

// The part of the polygon where `plane` is no higher than `other`.
std::vector<FloorPoint> clipped(const std::vector<FloorPoint>& polygon,
                                const PlanSlope& plane,
                                const PlanSlope& other) {
  std::vector<FloorPoint> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const FloorPoint& a = polygon[i];
    const FloorPoint& b = polygon[(i + 1) % polygon.size()];
    const double at_a = other.at(a) - plane.at(a);
    const double at_b = other.at(b) - plane.at(b);
    if (at_a >= 0.0) {
      kept.push_back(a);
    }
    if ((at_a < 0.0) != (at_b < 0.0)) {
      const double share = at_a / (at_a - at_b);
      kept.push_back({a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])});
    }
  }
  return kept;
}

Mesh outline_mesh(std::span<const FloorPoint> outline, double level, bool upwards) {
  Mesh mesh;
  mesh.vertices.reserve(outline.size());
  for (const FloorPoint& corner : outline) {
    mesh.vertices.push_back({corner[0], corner[1], level});
  }
  std::vector<std::uint32_t> corners(outline.size());
  std::iota(corners.begin(), corners.end(), 0U);
  if (upwards != (signed_area(outline) > 0.0)) {
    std::reverse(corners.begin() + 1, corners.end());
  }
  const auto cut = append_triangles(corners, mesh);
  RAYLOC_CHECK(cut.has_value());  // outline_mistake() has found no error
  return mesh;
}

}  // namespace

double PlanWall::length() const { return distance(from, to); }

double PlanRoom::ceiling_at(const FloorPoint& p) const {
  return lowest_of(planes_of(*this, height), p);
}

std::string name_in(const PlanRoom& room, const std::string& part) {
  return room.name.empty() ? part : room.name + "_" + part;
}

std::optional<std::string> outline_mistake(std::span<const FloorPoint> outline) {
  const std::size_t n = outline.size();
  if (n < 3 || n > kMaxOutlineCorners) {
    return "has " + std::to_string(n) + " corners; write 3 to " +
           std::to_string(kMaxOutlineCorners) + ", in the order of the outline";
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (distance(outline[i], outline[(i + 1) % n]) < kShortestWall) {
      return "has the corner " + corner_text(outline[i]) +
             " twice; the last corner is joined to the first without being written again";
    }
  }
  if (const std::size_t edge = first_crossing(outline); edge < n) {
    return "crosses itself: the wall from " + corner_text(outline[edge]) + " to " +
           corner_text(outline[(edge + 1) % n]) +
           " meets an earlier one; list the corners in the order of the outline";
  }
  if (std::abs(signed_area(outline)) < kMinRoomArea) {
    return "encloses no area; write the corners in metres";
  }
  return std::nullopt;
}

std::vector<FloorPoint> upper_edge(const PlanRoom& room,
                                   const FloorPoint& from,
                                   const FloorPoint& to,
                                   double highest) {
  const std::vector<PlanSlope> planes = planes_of(room, highest);
  std::vector<double> shares{0.0, 1.0};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const double at_from = planes[i].at(from) - planes[j].at(from);
      const double at_to = planes[i].at(to) - planes[j].at(to);
      if ((at_from < 0.0) != (at_to < 0.0)) {
        shares.push_back(std::clamp(at_from / (at_from - at_to), 0.0, 1.0));
      }
    }
  }
  std::sort(shares.begin(), shares.end());
  const double length = distance(from, to);
  std::vector<FloorPoint> top;
  for (const double share : shares) {
    const FloorPoint p{from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])};
    const FloorPoint bend{share * length, std::max(room.level, lowest_of(planes, p))};
    if (top.empty() || bend[0] - top.back()[0] > 1e-9) {
      top.push_back(bend);
    }
  }
  return top;
}

double lowest_between(std::span<const FloorPoint> top, double lower, double upper) {
  double lowest = std::min(height_at(top, piece_at(top, lower), lower),
                           height_at(top, piece_at(top, upper), upper));
  for (const FloorPoint& bend : top) {
    if (bend[0] > lower && bend[0] < upper) {
      lowest = std::min(lowest, bend[1]);
    }
  }
  return lowest;
}

void add_wall(PlanWall wall, std::vector<PlanWall>& walls) {
  for (PlanWall& earlier : walls) {
    const auto stretch = shared(wall, earlier);
    if (!stretch) {
      continue;
    }
    // The edge of the new wall, along the earlier one.
    std::vector<FloorPoint> edge;
    edge.reserve(wall.top.size());
    for (const FloorPoint& bend : wall.top) {
      edge.push_back({stretch->begin + (stretch->backwards ? -bend[0] : bend[0]), bend[1]});
    }
    if (stretch->backwards) {
      std::reverse(edge.begin(), edge.end());
    }
    earlier.top = higher_of(earlier.top, edge);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    wall.holes.push_back({earlier.name, {stretch->from, -kInfinity}, {stretch->to, kInfinity}});
  }
  walls.push_back(std::move(wall));
}

Mesh floor_mesh(const PlanRoom& room) { return outline_mesh(room.outline, room.level, true); }

Mesh ceiling_mesh(const PlanRoom& room) {
  Mesh flat = outline_mesh(room.outline, room.height, false);
  if (room.slopes.empty()) {
    return flat;
  }
  const std::vector<PlanSlope> planes = planes_of(room, room.height);
  Mesh mesh;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    for (const auto& triangle : flat.triangles) {
      std::vector<FloorPoint> piece;
      piece.reserve(triangle.size());
      for (const std::uint32_t index : triangle) {
        piece.push_back({flat.vertices[index].x, flat.vertices[index].y});
      }
      for (std::size_t j = 0; j < planes.size(); ++j) {
        if (j != k && !piece.empty()) {
          piece = clipped(piece, planes[k], planes[j]);
        }
      }
      if (piece.size() < 3 || std::abs(signed_area(piece)) < kMinPiece) {
        continue;
      }
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const FloorPoint& p : piece) {
        mesh.vertices.push_back({p[0], p[1], planes[k].at(p)});
      }
      for (std::uint32_t i = 2; i < piece.size(); ++i) {
        mesh.triangles.push_back({first, first + i - 1, first + i});
      }
    }
  }
  return mesh;
}

SheetFrame frame_of(const PlanWall& wall) {
  const double length = wall.length();
  return {{wall.from[0], wall.from[1], 0.0},
          {(wall.to[0] - wall.from[0]) / length, (wall.to[1] - wall.from[1]) / length, 0.0},
          {0.0, 0.0, 1.0},
          wall.faces_left};
}

}  // namespace rayloc
