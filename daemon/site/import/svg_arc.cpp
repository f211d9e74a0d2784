#include "daemon/site/import/svg_arc.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "daemon/site/import/placing.h"

namespace rayloc {

std::vector<FloorPoint> chords_of(const SvgArc& arc) {
  double rx = std::abs(arc.radii[0]);
  double ry = std::abs(arc.radii[1]);
  if (rx == 0.0 || ry == 0.0 || arc.from == arc.to) {
    return {arc.to};
  }
  // Equations F.6.5.1 to F.6.5.6; on the unit circle `half` is from the middle to `from`.
  const FloorPoint half =
      rotated_by(-arc.rotated)({0.5 * (arc.from[0] - arc.to[0]), 0.5 * (arc.from[1] - arc.to[1])});
  const double reach = std::hypot(half[0] / rx, half[1] / ry);
  const double scale = std::max(1.0, reach);
  rx *= scale;
  ry *= scale;
  const FloorPoint unit = {half[0] / rx, half[1] / ry};
  const double apart = unit[0] * unit[0] + unit[1] * unit[1];
  if (!(apart > 0.0)) {
    return {arc.to};  // flatter than a number can state
  }
  const double side = (arc.is_large == arc.is_clockwise ? -1.0 : 1.0) *
                      std::sqrt(std::max(0.0, (1.0 - apart) / apart));
  const FloorPoint centre = {side * unit[1], -side * unit[0]};
  const double begin = std::atan2(unit[1] - centre[1], unit[0] - centre[0]);
  const double end = std::atan2(-unit[1] - centre[1], -unit[0] - centre[0]);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double sweep = std::remainder(end - begin, kTurn);
  if (arc.is_clockwise != (sweep > 0.0)) {
    sweep += arc.is_clockwise ? kTurn : -kTurn;
  }
  const int count =
      std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / kTurn * kChordsOfATurn)));
  const FloorPoint middle = {0.5 * (arc.from[0] + arc.to[0]), 0.5 * (arc.from[1] + arc.to[1])};
  const Placing ellipse = rotated_by(arc.rotated);
  std::vector<FloorPoint> corners;
  corners.reserve(static_cast<std::size_t>(count));
  for (int i = 1; i < count; ++i) {
    const double at = begin + sweep * i / count;
    const FloorPoint corner =
        ellipse({rx * (centre[0] + std::cos(at)), ry * (centre[1] + std::sin(at))});
    corners.push_back({middle[0] + corner[0], middle[1] + corner[1]});
  }
  corners.push_back(arc.to);
  return corners;
}

}  // namespace rayloc
