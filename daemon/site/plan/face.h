// Face: a convex part of a surface, for a picture.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

struct Face {
  std::vector<Vec3d> corners;  // [m], in the order of the outline
  // By edge, starting at the corner of the same number: true for
  // an edge of the surface, false for a seam between two faces.
  std::vector<bool> outlined;
  Vec3d normal;        // outwards for a closed object, else arbitrary
  bool solid = false;  // face of a closed object: visible from outside only
  std::uint32_t object = 0;
};

// All surfaces: a convex one as one face, any other as its triangles.
std::vector<Face> scene_faces(const Scene& scene);

}  // namespace rayloc::draw
