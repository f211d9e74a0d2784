// Meshes from bytes, for tests that do not examine the notes of a reader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/read/mesh_reader.h"

namespace rayloc {

inline Expected<Mesh> read_mesh(std::string_view bytes, const std::string& name) {
  std::vector<SceneNote> notes;
  return read_mesh(bytes, name, notes);
}
inline Expected<Mesh> read_ply(std::string_view bytes, const std::string& name) {
  std::vector<SceneNote> notes;
  return read_ply(bytes, name, notes);
}
inline Expected<Mesh> read_obj(std::string_view bytes, const std::string& name) {
  std::vector<SceneNote> notes;
  return read_obj(bytes, name, notes);
}

}  // namespace rayloc
