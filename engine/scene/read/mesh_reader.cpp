#include "engine/scene/read/mesh_reader.h"

#include <algorithm>
#include <cstddef>

namespace rayloc {

Expected<Mesh> read_mesh(std::string_view bytes,
                         const std::string& name,
                         std::vector<SceneNote>& notes) {
  std::string ending = name.substr(name.size() - std::min<std::size_t>(name.size(), 4));
  std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (ending == ".ply") {
    return read_ply(bytes, name, notes);
  }
  if (ending == ".obj") {
    return read_obj(bytes, name, notes);
  }
  return bad_input(name + ": a mesh is read from a .ply or .obj file");
}

}  // namespace rayloc
