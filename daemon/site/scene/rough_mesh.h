// Detects scanned meshes: their faces are rough on surfaces that are meant to be planar.
//
// Each triangle of a scan is a mirror of its own, and none represents the wall. A mesh of many
// intended faces (a sphere, a room full of furniture) has as many surfaces, and needs no warning.
#pragma once

#include "engine/scene/mesh.h"

namespace rayloc {

// True if the mesh is as large as a room's wall, most of its neighbouring triangles meet at a small
// angle, and its flatter patches of a metre are planar up to a few centimetres, with normals that
// differ across the patch no more than across half of it: that is noise. On a bent surface the
// difference grows with the distance.
bool is_rough_mesh(const Mesh& mesh);

}  // namespace rayloc
