// Faces of different objects that lie in one plane and cover each other.
//
// Where two such mirrors can both be seen from one side, which of them a wave meets is chance, and
// the channel that of another room. Where they face each other (a cabinet on the floor) nothing
// sees either.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc {

struct SurfaceOverlap {
  std::uint32_t first = 0;  // indices of surfaces
  std::uint32_t second = 0;
  double area = 0.0;     // [m^2]
  bool doubled = false;  // both can be seen from a side on which something of the scene is
};

// In the order of the surfaces; overlaps of less than a square millimetre are left out.
std::vector<SurfaceOverlap> find_overlaps(const Scene& scene);

}  // namespace rayloc
