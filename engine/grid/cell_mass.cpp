#include "engine/grid/cell_mass.h"

namespace rayloc {

CellMoments uniform_moments(const Grid& grid) {
  CellMoments m;
  m.xx = grid.step_x * grid.step_x / 12.0;
  m.yy = grid.step_y * grid.step_y / 12.0;
  m.zz = grid.height_sigma * grid.height_sigma;
  return m;
}

}  // namespace rayloc
