// Lattice: equally spaced positions in plan around a centre.
#pragma once

#include <cstddef>

#include "engine/base/vec3.h"

namespace rayloc {

struct Lattice {
  std::size_t count_x = 1;
  std::size_t count_y = 1;
  double step_x = 0.0;  // [m]
  double step_y = 0.0;

  std::size_t size() const { return count_x * count_y; }
  Vec3d offset(std::size_t x, std::size_t y) const {
    return {step_x * (static_cast<double>(x) - 0.5 * static_cast<double>(count_x - 1)),
            step_y * (static_cast<double>(y) - 0.5 * static_cast<double>(count_y - 1)),
            0.0};
  }
};

}  // namespace rayloc
