// Where a horizontal plane cuts a mesh: what the plan of a room shows of its walls.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc::draw {

struct MeshSection {
  std::vector<std::vector<Vec3d>> loops;  // closed, the first corner not repeated: of bodies
  std::vector<std::vector<Vec3d>> lines;  // of sheets
};

MeshSection cut_mesh(const Mesh& mesh, double z);

}  // namespace rayloc::draw
