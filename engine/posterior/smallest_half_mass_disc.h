// smallest_half_mass_disc: the smallest disc that holds half of a posterior's mass.
//
// The centre of this disc has the least median error of all places (in robust
// statistics, the centre of the least median of squares: Rousseeuw, JASA 79,
// 1984).
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/grid/grid.h"

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

// The first disc with half of the mass, of radii from `least` [m] on, each a fifth larger than the
// previous one, centred on a cell of the grid. mass: of each cell, sums to 1.
Disc smallest_half_mass_disc(const Grid& grid, const std::vector<double>& mass, double least);

}  // namespace rayloc
