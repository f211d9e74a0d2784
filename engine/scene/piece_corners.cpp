#include "engine/scene/piece_corners.h"

#include <cstddef>

namespace rayloc {

std::vector<Vec3d> piece_corners(const Surface& surface, const Surface::Piece& piece) {
  const auto edges = surface.edges(piece);
  std::vector<Vec3d> corners;
  corners.reserve(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Surface::Edge& e = edges[i];
    const Surface::Edge& f = edges[(i + 1) % edges.size()];
    const double turn = e.a * f.b - e.b * f.a;
    const double u = (e.b * f.c - e.c * f.b) / turn;
    const double v = (e.c * f.a - e.a * f.c) / turn;
    corners.push_back(surface.origin() + u * surface.u_axis() + v * surface.v_axis());
  }
  return corners;
}

}  // namespace rayloc
