#include "daemon/site/import/dxf/dxf_curves.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/svg_arc.h"

namespace rayloc {
namespace {

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;  // [rad], rounding of angles in text
// [rad], same of a whole turn, which some programs write with six digits (6.28319).
constexpr double kRoundedTurn = 1e-4;

// Bulges, chosen: a flatter arc is its chord, a fuller one has a chord of no length.
constexpr double kMinBulge = 1e-6;
constexpr double kMaxBulge = 1e6;

// Anticlockwise, above 0 and up to a whole turn.
double sweep_of(const DxfArc& arc) {
  if (std::abs(std::abs(arc.end - arc.begin) - kWholeTurn) < kRoundedTurn) {
    return kWholeTurn;
  }
  const double sweep =
      std::fmod(std::fmod(arc.end, kWholeTurn) - std::fmod(arc.begin, kWholeTurn), kWholeTurn);
  return sweep > kSameAngle ? sweep : sweep + kWholeTurn;
}

}  // namespace

std::vector<FloorPoint> corners_of(const std::vector<DxfVertex>& vertices, bool is_closed) {
  std::vector<FloorPoint> corners;
  const std::size_t n = vertices.size();
  corners.reserve(n);
  for (std::size_t i = 0; i < n && corners.size() <= kMaxDrawnPoints; ++i) {
    const FloorPoint& from = vertices[i].at;
    corners.push_back(from);
    const double size = std::abs(vertices[i].bulge);
    const FloorPoint& to = vertices[(i + 1) % n].at;
    const double radius = 0.25 * std::hypot(to[0] - from[0], to[1] - from[1]) * (size + 1.0 / size);
    const bool is_last = i + 1 == n && !is_closed;
    if (is_last || size < kMinBulge || size > kMaxBulge || !std::isfinite(radius)) {
      continue;
    }
    // y points up here, so that "clockwise" of SVG is anticlockwise.
    const std::vector<FloorPoint> chords =
        chords_of({from, to, {radius, radius}, 0.0, size > 1.0, vertices[i].bulge > 0.0});
    corners.insert(corners.end(), chords.begin(), chords.end() - 1);
  }
  return corners;
}

bool is_whole(const DxfArc& arc) { return sweep_of(arc) > kWholeTurn - kSameAngle; }

std::vector<FloorPoint> points_of(const DxfArc& arc) {
  const double sweep = sweep_of(arc);
  const int count =
      std::max(1, static_cast<int>(std::ceil(sweep / kWholeTurn * kChordsOfATurn - kSameAngle)));
  const int last = is_whole(arc) ? count - 1 : count;
  const FloorPoint minor = {-arc.ratio * arc.major[1], arc.ratio * arc.major[0]};
  std::vector<FloorPoint> points;
  points.reserve(static_cast<std::size_t>(count) + 1);
  for (int i = 0; i <= last; ++i) {
    const double angle = arc.begin + sweep * i / count;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    points.push_back({arc.centre[0] + c * arc.major[0] + s * minor[0],
                      arc.centre[1] + c * arc.major[1] + s * minor[1]});
  }
  return points;
}

}  // namespace rayloc
