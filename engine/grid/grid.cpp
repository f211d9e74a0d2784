#include "engine/grid/grid.h"

#include <cmath>

#include "engine/base/check.h"

namespace rayloc {

Grid::Grid(const Vec3d& bounds_min, const Vec3d& bounds_max, double height, double step) {
  const double width_x = bounds_max.x - bounds_min.x;
  const double width_y = bounds_max.y - bounds_min.y;
  RAYLOC_CHECK(width_x > 0.0 && width_y > 0.0 && step > 0.0);
  count_x = static_cast<std::size_t>(std::ceil(width_x / step));
  count_y = static_cast<std::size_t>(std::ceil(width_y / step));
  step_x = width_x / static_cast<double>(count_x);
  step_y = width_y / static_cast<double>(count_y);
  first = {bounds_min.x + 0.5 * step_x, bounds_min.y + 0.5 * step_y, height};
}

std::size_t Grid::cell_at(double x, double y) const {
  const double column = (x - first.x) / step_x + 0.5;
  const double row = (y - first.y) / step_y + 0.5;
  if (!(column >= 0.0 && row >= 0.0 && column < static_cast<double>(count_x) &&
        row < static_cast<double>(count_y))) {
    return size();
  }
  return static_cast<std::size_t>(column) * count_y + static_cast<std::size_t>(row);
}

}  // namespace rayloc
