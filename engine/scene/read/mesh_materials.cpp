#include "engine/scene/read/mesh_materials.h"

namespace rayloc {

void note_materials(const std::set<std::string>& materials,
                    const std::string& name,
                    std::vector<SceneNote>& notes) {
  if (materials.size() < 2) {
    return;
  }
  std::string names;
  std::size_t count = 0;
  for (const std::string& material : materials) {
    if (count == kMaxNamedMaterials) {
      names += " and more";
      break;
    }
    names += (count++ == 0 ? "" : ", ") + material;
  }
  notes.push_back({"mesh_materials",
                   {},
                   name + ": the faces have several materials (" + names +
                       "), and the one of the shape counts for all of them; separate the mesh by "
                       "material in Blender, and export a shape for each"});
}

}  // namespace rayloc
