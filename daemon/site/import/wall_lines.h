// Finds the walls of a plan from the lines of its
// drawing: two lines for the two faces of a wall, or one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/base/outline.h"

namespace rayloc {

struct WallLine {
  FloorPoint from{};  // [m]
  FloorPoint to{};
  std::string layer;
  double thickness = 0.0;  // [m], between two lines; 0: from one line
};

// Pairs of parallel lines within kThickest become one line between them, over their common length;
// nearer ones first. The rest of a line is kept, except pieces no longer than a wall's thickness:
// the ends of walls and the excess length outside of a corner. Short chords of a curve are kept.
inline constexpr double kThinnest = 0.04;  // [m], chosen: for a wall, closer is the same line
inline constexpr double kThickest = 0.5;   // [m], chosen
std::vector<WallLine> wall_lines(const std::vector<WallLine>& drawn);

// Removes the part within kThickest of the line between its ends: the place of a window.
std::vector<WallLine> cut_at(const std::vector<WallLine>& walls, const WallLine& opening);

double length_of(const WallLine& line);

}  // namespace rayloc
