// Inside and outside of a mesh. A wave that does not cross surfaces stays on one side of a closed
// object, so half of its faces need never be considered.
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// A mesh is closed when every edge belongs to equally many triangles in both of its directions;
// vertices at one position count as one.
struct Solid {
  // Connected shells; 0 when the mesh is not closed, or when some shells are turned inside out and
  // others are not. A shell must not intersect itself.
  int shells = 0;
  int orientation = 0;  // +1: the triangles' normals point outwards, -1: inwards
};

Solid classify_solid(const Mesh& mesh);

// Winding number about a point: `orientation` times the number of shells around it; an intermediate
// value on a face, an edge or a corner.
double winding_number(const Mesh& mesh, const Vec3d& point);

// True if a shell is around the point. For a mesh that is not closed: true if the absolute winding
// number is above one half.
bool is_inside(const Mesh& mesh, const Vec3d& point);

}  // namespace rayloc
