// Section of a mesh with a horizontal plane: the outline of walls on the plan of a room.
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
  std::vector<std::vector<Vec3d>> loops;  // closed, without the repeated first corner: for bodies
  std::vector<std::vector<Vec3d>> lines;  // for sheets
};

MeshSection cut_mesh(const Mesh& mesh, double z);

}  // namespace rayloc::draw
