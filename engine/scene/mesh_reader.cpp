#include "engine/scene/mesh_reader.h"

namespace rayloc {

Expected<Mesh> read_mesh(std::string_view bytes, const std::string& name) {
  if (name.ends_with(".ply")) {
    return read_ply(bytes, name);
  }
  if (name.ends_with(".obj")) {
    return read_obj(bytes, name);
  }
  return bad_input(name + ": a mesh is read from a .ply or .obj file");
}

}  // namespace rayloc
