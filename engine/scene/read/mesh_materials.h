// Handles a mesh whose faces have several materials, while a shape has one. Internal to read_mesh.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "engine/scene/scene_note.h"

namespace rayloc {

// A count, chosen: the limit for names in a message.
inline constexpr std::size_t kMaxNamedMaterials = 8;

// Adds a note if the faces have more than one material. `name` is that of the file.
void note_materials(const std::set<std::string>& materials,
                    const std::string& name,
                    std::vector<SceneNote>& notes);

}  // namespace rayloc
