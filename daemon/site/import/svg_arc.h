// The arcs of ellipses in paths of SVG (W3C, SVG 1.1 appendix F.6), and of circles in DXF.
#pragma once

#include <vector>

#include "engine/base/outline.h"

namespace rayloc {

struct SvgArc {
  FloorPoint from;
  FloorPoint to;
  FloorPoint radii;           // scaled up if the ends are too far apart for them
  double rotated = 0.0;       // [rad], rotation of the ellipse, from +x to +y of the drawing
  bool is_large = false;      // the longer of the two arcs on an ellipse
  bool is_clockwise = false;  // "sweep", y pointing down
};

inline constexpr int kChordsOfATurn = 32;  // count, chosen: half a percent off, as for curves

// Corners of its chords without the first; the last is `to`. One chord if a radius is 0.
std::vector<FloorPoint> chords_of(const SvgArc& arc);

}  // namespace rayloc
