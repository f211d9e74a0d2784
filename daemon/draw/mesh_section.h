// Where a horizontal plane cuts a mesh: what the plan of a room shows of its walls.
#pragma once

#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc::draw {

// An edge of a mesh as a key, the same in both its triangles: lower place first.
using Place = std::tuple<double, double, double>;
using Edge = std::pair<Place, Place>;

inline Place place_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

struct MeshSection {
  std::vector<std::vector<Vec3d>> loops;  // closed, the first corner not repeated: of bodies
  std::vector<std::vector<Vec3d>> lines;  // of sheets
};

MeshSection cut_mesh(const Mesh& mesh, double z);

}  // namespace rayloc::draw
