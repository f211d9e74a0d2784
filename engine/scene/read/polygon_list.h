// PolygonList: the faces of a mesh file as written, with any number of corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/mesh.h"

namespace rayloc {

// Files may list faces before their vertices, so faces are cut after the whole file is read.
class PolygonList {
 public:
  void add_corner(std::uint32_t vertex) { corners_.push_back(vertex); }
  // Call after the corners of each face.
  void end_face() { ends_.push_back(corners_.size()); }

  std::size_t size() const { return ends_.size(); }

  // Cuts the faces into triangles of `mesh`, whose vertices are complete. place_of(i): place of
  // face i in the file ("a.obj:12"). An Error, with place and number of the face (from 1), when a
  // face refers to a vertex that does not exist or cannot be cut (triangulate.h).
  template <typename PlaceOf>
  Expected<void> append_to(Mesh& mesh, const PlaceOf& place_of) const {
    for (std::size_t i = 0; i < size(); ++i) {
      if (auto cut = append_face(i, mesh); !cut) {
        return bad_input(place_of(i) + ": face " + std::to_string(i + 1) + " of " +
                         std::to_string(size()) + ": " + cut.error().message);
      }
    }
    return {};
  }

 private:
  Expected<void> append_face(std::size_t i, Mesh& mesh) const;

  std::vector<std::uint32_t> corners_;
  std::vector<std::size_t> ends_;  // in corners_, of each face
};

}  // namespace rayloc
