// Face: a convex part of a surface, as a picture shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

struct Face {
  std::vector<Vec3d> corners;  // [m], in the order of the outline
  // Of each edge, from the corner of the same number on: whether it is an edge of the surface, and
  // not a seam between two faces.
  std::vector<bool> outlined;
  Vec3d normal;        // of a closed object outwards, else either way
  bool solid = false;  // of a closed object: seen from outside only
  std::uint32_t object = 0;
};

// All surfaces: a convex one as one face, any other as its triangles.
std::vector<Face> scene_faces(const Scene& scene);

}  // namespace rayloc::draw
