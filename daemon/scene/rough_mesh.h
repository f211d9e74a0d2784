// Is a mesh a scan: are its faces rough, where they are meant to be plane?
//
// Each triangle of a scan is a mirror of its own, and no wave meets a wall. A mesh of many honest
// faces (a sphere, a room full of furniture) has as many surfaces, and needs no warning.
#pragma once

#include "engine/scene/mesh.h"

namespace rayloc {

// Whether the mesh is as large as a room's wall, most of its neighbouring triangles meet at a small
// angle, and its flatter patches of a metre are plane up to a few centimetres, with
// normals that differ across the patch no more than across half of it: that is noise. Where a
// surface bends, the difference grows with the distance.
bool is_rough_mesh(const Mesh& mesh);

}  // namespace rayloc
