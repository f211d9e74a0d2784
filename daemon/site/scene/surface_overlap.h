// Finds coplanar faces of different objects that cover each other.
//
// If two such mirrors are both visible from one side, the reflecting
// one is arbitrary, and the channel is that of another room. If they
// face each other (a cabinet on the floor), no ray reaches either.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc {

struct SurfaceOverlap {
  std::uint32_t first = 0;  // indices of surfaces
  std::uint32_t second = 0;
  double area = 0.0;     // [m^2]
  bool doubled = false;  // both are visible from a side with other parts of the scene
};

// In the order of the surfaces; overlaps of less than a square millimetre are left out.
std::vector<SurfaceOverlap> find_overlaps(const Scene& scene);

}  // namespace rayloc
