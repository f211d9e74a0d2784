#include "engine/trace/diffuse/surface_patches.h"

#include <algorithm>
#include <cstddef>

#include "engine/scene/piece_corners.h"

namespace rayloc {
namespace {

std::size_t longest(const std::array<Vec3d, 3>& corners) {
  std::size_t found = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d edge = corners.at((i + 1) % 3) - corners.at(i);
    if (dot(edge, edge) > most) {
      most = dot(edge, edge);
      found = i;
    }
  }
  return found;
}

}  // namespace

double SurfaceTriangle::longest_edge() const {
  const std::size_t i = longest(corners);
  return norm(corners.at((i + 1) % 3) - corners.at(i));
}

std::pair<SurfaceTriangle, SurfaceTriangle> SurfaceTriangle::halves() const {
  const std::size_t i = longest(corners);
  const Vec3d& from = corners.at(i);
  const Vec3d& to = corners.at((i + 1) % 3);
  const Vec3d& tip = corners.at((i + 2) % 3);
  const Vec3d half = 0.5 * (from + to);
  return {{surface, {from, half, tip}}, {surface, {half, to, tip}}};
}

std::vector<SurfaceTriangle> triangles_of(const Scene& scene, std::uint32_t surface) {
  std::vector<SurfaceTriangle> triangles;
  for (const Surface::Piece& piece : scene.surfaces()[surface].pieces()) {
    const std::vector<Vec3d> corners = piece_corners(scene.surfaces()[surface], piece);
    triangles.reserve(triangles.size() + corners.size());
    for (std::size_t i = 2; i < corners.size(); ++i) {
      triangles.push_back({surface, {corners[0], corners[i - 1], corners[i]}});
    }
  }
  return triangles;
}

}  // namespace rayloc
