// BoxLattice: boxes of about 10 x 10 cm x 0.3 m over a grid: blocks of its cells and equal parts of
// the heights of its layers.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/base/vec3.h"
#include "engine/grid/grid.h"

namespace rayloc {

class BoxLattice {
 public:
  explicit BoxLattice(const Grid& grid);
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::size_t size() const { return count_x_ * count_y_ * layers_; }  // boxes of the whole grid
  // The box of a position [m], world axes; kNone outside the grid or its heights. At a known height
  // z is ignored.
  std::uint32_t box_at(float x, float y, float z) const;
  Vec3d middle(std::uint32_t box) const;  // [m], of the cells that the box has
  Vec3d half() const;  // half of the sides of a box inside the grid [m]; z = 0 at a known height
  // The cell whose rays the box has: that nearest to its middle.
  std::size_t cell(std::uint32_t box) const;
  const Grid& grid() const { return grid_; }
  bool is_height_known() const { return thickness_ <= 0.0; }

 private:
  struct Cells {  // along one axis
    std::size_t first = 0;
    std::size_t last = 0;
  };
  Cells cells_x(std::uint32_t box) const;
  Cells cells_y(std::uint32_t box) const;

  Grid grid_;
  std::size_t block_ = 1;  // cells of a box along x and along y
  std::size_t count_x_ = 0;
  std::size_t count_y_ = 0;
  std::size_t layers_ = 1;
  double low_ = 0.0;        // [m], lower end of the heights
  double thickness_ = 0.0;  // [m], of a box; 0: the height is known
};

}  // namespace rayloc
