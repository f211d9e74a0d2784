// scene.xml as the objects of a draft, and changed objects as scene.xml: only what differs is
// written, where it stands; comments and order stay.
#pragma once

#include <string>
#include <vector>

#include "daemon/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

// Shapes that are at the top of the scene, in their order. `name`: of the file, for messages.
Expected<std::vector<DraftObject>> read_scene_text(const std::string& xml, const std::string& name);

// The names of its materials, as objects have them.
std::vector<std::string> scene_materials(const std::string& xml);

// The scene with the objects that are wanted. An object that is new becomes a <shape> of type cube
// or rectangle; a material that the file does not have becomes a <bsdf> of ITU-R P.2040-4.
Expected<std::string> edit_scene_text(const std::string& xml,
                                      const std::string& name,
                                      const std::vector<DraftObject>& wanted);

}  // namespace rayloc
