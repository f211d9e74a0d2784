// A mesh whose faces have several materials, where a shape has one. Internal to read_mesh.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "engine/scene/scene_note.h"

namespace rayloc {

// A count, chosen: a message names no more.
inline constexpr std::size_t kMostNamedMaterials = 8;

// Notes more than one material of faces. `name` is that of the file.
void note_materials(const std::set<std::string>& materials,
                    const std::string& name,
                    std::vector<SceneNote>& notes);

}  // namespace rayloc
