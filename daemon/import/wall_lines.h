// The walls of a plan from the lines that its drawing has of them: two lines for the two faces of a
// wall, or one.
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
  double thickness = 0.0;  // [m], between two lines; 0: of one line
};

// Pairs of parallel lines within kThickest become one line between them, as long as they run side
// by side; nearer ones first. What is left of a line stays, but for pieces that are no longer than
// a wall is thick: the ends of walls and what is longer outside of a corner than inside.
inline constexpr double kThinnest = 0.04;  // [m], chosen: of a wall, closer is the same line
inline constexpr double kThickest = 0.5;   // [m], chosen
std::vector<WallLine> wall_lines(const std::vector<WallLine>& drawn);

// Without what lies within kThickest of the line between its ends: where a window stands.
std::vector<WallLine> cut_at(const std::vector<WallLine>& walls, const WallLine& opening);

double length_of(const WallLine& line);

}  // namespace rayloc
