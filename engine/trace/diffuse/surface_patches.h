// Triangles of surfaces, which can be cut to any required size.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

struct SurfaceTriangle {
  std::uint32_t surface = 0;
  std::array<Vec3d, 3> corners;  // [m], world

  double area() const {
    return 0.5 * norm(cross(corners[1] - corners[0], corners[2] - corners[0]));
  }
  Vec3d middle() const { return (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]); }
  double longest_edge() const;                                 // [m]
  std::pair<SurfaceTriangle, SurfaceTriangle> halves() const;  // cut at the middle of that edge
};

// The triangles of the whole surface.
std::vector<SurfaceTriangle> triangles_of(const Scene& scene, std::uint32_t surface);

// Cuts until no edge is longer than `most_edge(triangle)` [m].
template <typename MostEdge>
void cut(const SurfaceTriangle& triangle,
         const MostEdge& most_edge,
         std::vector<SurfaceTriangle>& pieces) {
  std::vector<SurfaceTriangle> left{triangle};
  while (!left.empty()) {
    const SurfaceTriangle next = left.back();
    left.pop_back();
    if (next.longest_edge() <= most_edge(next)) {
      pieces.push_back(next);
      continue;
    }
    const auto [first, second] = next.halves();
    left.push_back(second);
    left.push_back(first);
  }
}

}  // namespace rayloc
