// The offsets of a cube, for a search about a place where a descent would end in a wrong minimum.
#pragma once

#include <cstddef>

#include "engine/base/vec3.h"

namespace rayloc {

// Offsets -reach ... +reach along each axis, in whole steps.
class OffsetCube {
 public:
  explicit OffsetCube(int reach) : reach_(reach) {}

  std::size_t size() const {
    const std::size_t side = 2 * static_cast<std::size_t>(reach_) + 1;
    return side * side * side;
  }

  // REQUIRES: n < size(). The middle one is zero.
  Vec3d operator[](std::size_t n) const {
    const int side = 2 * reach_ + 1;
    const auto i = static_cast<int>(n);
    const int x = i / (side * side) - reach_;
    const int y = i / side % side - reach_;
    const int z = i % side - reach_;
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }

 private:
  int reach_;
};

}  // namespace rayloc
