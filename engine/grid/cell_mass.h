// CellMass: distribution of a probability mass inside a cell of a grid.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "engine/grid/grid.h"

namespace rayloc {

// Distribution inside a cell: the mean's offset from the centre [m] and the covariance.
struct CellMoments {
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;  // [m^2]
  double xy = 0.0;
  double yy = 0.0;
  double z = 0.0;  // for a target at an unknown height
  double xz = 0.0;
  double yz = 0.0;
  double zz = 0.0;
};
// Uniform distribution in the cell.
CellMoments uniform_moments(const Grid& grid);

// Distributions of all of a cell's mass, and of the part around its best place.
struct CellMass {
  CellMoments all;
  CellMoments best;
  double best_share = 1.0;
  std::vector<float> layers = {};  // share of each of Grid::layers; empty: known height
};

// Cells with a known inner distribution; all others are uniform.
using RefinedCells = std::vector<std::pair<std::size_t, CellMass>>;

}  // namespace rayloc
