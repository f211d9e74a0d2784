// Mesh: triangles that share vertices, as a PLY or OBJ file holds them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"

namespace rayloc {

struct Mesh {
  std::vector<Vec3d> vertices;                          // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into `vertices`
  // How far a vertex may be from where it was meant to be, as far as its file tells [m].
  double rounding = 0.0;
};

}  // namespace rayloc
