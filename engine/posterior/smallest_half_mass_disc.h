// smallest_half_mass_disc: where half of a posterior's mass is as near together as it gets.
//
// Of all places the middle of the smallest disc that holds half of the mass has the least median
// error (in robust statistics, the centre of the least median of squares: Rousseeuw, JASA 79,
// 1984).
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/posterior/posterior.h"

namespace rayloc {

struct Disc {
  Vec3d centre;
  double radius = 0.0;  // [m]

  bool contains(const Vec3d& position) const {
    const double x = position.x - centre.x;
    const double y = position.y - centre.y;
    return x * x + y * y <= radius * radius;
  }
};

// The first that does, of discs of `least` [m] and more, each a fifth wider than the one before and
// about a cell of the grid. mass: of each cell, 1 in all.
Disc smallest_half_mass_disc(const RoomGrid& grid, const std::vector<double>& mass, double least);

}  // namespace rayloc
