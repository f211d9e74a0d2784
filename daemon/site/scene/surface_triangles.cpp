#include "daemon/site/scene/surface_triangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace rayloc {
namespace {

// Largest distance of the triangle from the plane [m].
double misfit(const Plane<double>& plane, const Triangle& t) {
  double furthest = 0.0;
  for (const Vec3d& corner : t) {
    furthest = std::max(furthest, std::abs(distance(plane, corner)));
  }
  return furthest;
}

}  // namespace

std::vector<std::vector<Triangle>> surface_triangles(const Scene& scene) {
  std::vector<std::vector<Triangle>> triangles(scene.surfaces().size());
  std::uint32_t begin = 0;  // of the object's surfaces, which are consecutive
  for (std::uint32_t object = 0; object < scene.objects().size(); ++object) {
    std::uint32_t end = begin;
    while (end < triangles.size() && scene.owner(end).object == object) {
      ++end;
    }
    const Mesh& mesh = scene.objects()[object].mesh;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Triangle t{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
      std::uint32_t best = begin;
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t i = begin; i < end && least > 0.0; ++i) {
        const double off = misfit(scene.surfaces()[i].plane(), t);
        if (off < least) {
          least = off;
          best = i;
        }
      }
      triangles[best].push_back(t);
    }
    begin = end;
  }
  return triangles;
}

}  // namespace rayloc
