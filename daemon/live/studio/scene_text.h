// Converts scene.xml to the objects of a draft, and changed objects to scene.xml: only differences
// are written, in place; comments and order stay.
#pragma once

#include <string>
#include <vector>

#include "daemon/live/studio/site_draft.h"
#include "engine/base/expected.h"

namespace rayloc {

// Shapes at the top level of the scene, in their order. `name`: file name in messages.
Expected<std::vector<DraftObject>> read_scene_text(const std::string& xml, const std::string& name);

// The names of its materials, as referenced by objects.
std::vector<std::string> scene_materials(const std::string& xml);

// The scene with the requested objects. A new object becomes a <shape> of type cube or rectangle; a
// material that the file does not have becomes a <bsdf> of ITU-R P.2040-4.
Expected<std::string> edit_scene_text(const std::string& xml,
                                      const std::string& name,
                                      const std::vector<DraftObject>& wanted);

}  // namespace rayloc
