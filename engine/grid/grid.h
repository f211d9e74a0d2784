// Grid: equal cells over a room in plan (x, y), and layers of heights about their centres.
#pragma once

#include <cstddef>

#include "engine/base/vec3.h"
#include "engine/grid/height_layers.h"

namespace rayloc {

// Cells are numbered with x outermost; all centres are at one height.
struct Grid {
  Vec3d first;                // [m], centre of cell (0, 0)
  double height_sigma = 0.0;  // [m], of a target about that height; 0: known height
  double step_x = 0.0;        // [m]
  double step_y = 0.0;
  std::size_t count_x = 0;
  std::size_t count_y = 0;
  HeightLayers layers;  // about the height of the cells; by default one layer

  // Covers the bounds with cells of about `step`. REQUIRES: step and both widths are positive.
  Grid(const Vec3d& bounds_min, const Vec3d& bounds_max, double height, double step);

  std::size_t size() const { return count_x * count_y; }
  // The cell of a position in plan; size() outside the grid, or where it is not a number.
  std::size_t cell_at(double x, double y) const;
  Vec3d centre(std::size_t cell) const {
    const std::size_t x = cell / count_y;
    const std::size_t y = cell % count_y;
    return {first.x + step_x * static_cast<double>(x),
            first.y + step_y * static_cast<double>(y),
            first.z};
  }
};

}  // namespace rayloc
