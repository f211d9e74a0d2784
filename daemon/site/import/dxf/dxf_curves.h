// Curves of a DXF file, as chords of at most a 32nd of a turn (chords_of).
#pragma once

#include <vector>

#include "engine/base/outline.h"

namespace rayloc {

// A corner of a polyline, and the curve from it to the next one.
struct DxfVertex {
  FloorPoint at{};
  double bulge = 0.0;  // tangent of a quarter of the arc's angle; above 0: anticlockwise
};

// All corners, with those of the chords between them. A closed line has an arc from its last corner
// to its first, too. No more than a few beyond kMaxDrawnPoints.
std::vector<FloorPoint> corners_of(const std::vector<DxfVertex>& vertices, bool is_closed);

// An arc of an ellipse.
struct DxfArc {
  FloorPoint centre{};
  FloorPoint major{};  // from the centre to an end of the major axis
  double ratio = 1.0;  // of the minor axis to the major one; below 0: it runs clockwise
  double begin = 0.0;  // [rad], from the major axis, of the circle that becomes the ellipse
  double end = 0.0;    // [rad]; a whole turn if equal to `begin`
};

// True for a whole turn.
bool is_whole(const DxfArc& arc);

// Its points from `begin` to `end`; those of a whole ellipse do not repeat the first one.
std::vector<FloorPoint> points_of(const DxfArc& arc);

}  // namespace rayloc
