// Mesh: triangles that share vertices, as in a PLY or OBJ file.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"

namespace rayloc {

struct Mesh {
  std::vector<Vec3d> vertices;                          // [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // indices into `vertices`
  // Rounding error of vertices, as far as it can be derived from the file [m].
  double rounding = 0.0;
};

}  // namespace rayloc
