#include "engine/scene/read/polygon_list.h"

#include "engine/scene/read/triangulate.h"

namespace rayloc {

Expected<void> PolygonList::append_face(std::size_t i, Mesh& mesh) const {
  const std::size_t first = i == 0 ? 0 : ends_[i - 1];
  const auto face = std::span(corners_).subspan(first, ends_[i] - first);
  for (const std::uint32_t vertex : face) {
    if (vertex >= mesh.vertices.size()) {
      return bad_input("it refers to vertex " + std::to_string(vertex) + " of " +
                       std::to_string(mesh.vertices.size()) + ", counted from 0");
    }
  }
  return append_triangles(face, mesh);
}

}  // namespace rayloc
