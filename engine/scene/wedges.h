// Wedges: the edges of a scene at which waves are diffracted.
//
// About every edge of a surface the surfaces that end or pass there are half planes. Where the
// largest sector between two of them is more than half a turn, they make a wedge of that sector:
// the outer edge of a body, or for a single half plane the free edge of a sheet. Coplanar
// neighbours make none, nor do edges that lie on another surface, hollow corners, or flush bodies.
// The result does not depend on the objects of the surfaces or on the meshing.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct Wedge {
  Vec3d from, to;            // [m], ends of the edge
  Vec3d along;               // unit, from `from` to `to`; azimuths grow about it
  Vec3d in_face;             // unit, across the edge in face 0: azimuth 0
  Vec3d normal;              // unit, along x in_face: azimuth pi / 2
  double n = 2.0;            // exterior angle over pi, in (1, 2]
  std::uint32_t face_0 = 0;  // surfaces
  std::uint32_t face_n = 0;

  // Unit normal out of face n.
  Vec3d normal_n() const {
    const double sector = n * std::numbers::pi;
    return std::sin(sector) * in_face - std::cos(sector) * normal;
  }
  bool is_free() const { return face_0 == face_n; }  // the edge of a sheet
};

// In the order of their surfaces. Wedges that continue each other may be a tolerance of the meshes
// apart, 10 um. The run time grows as the number of surfaces squared.
std::vector<Wedge> find_wedges(const Scene& scene);

}  // namespace rayloc
