// What an object most likely is, by its measures: a picture shows floors, walls and furniture each
// in its way. Only pictures depend on this.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/scene/bounds.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

enum class PartKind : std::uint8_t { kFloor, kCeiling, kWall, kFurniture };

struct ScenePart {
  PartKind kind = PartKind::kFurniture;
  Bounds bounds;
  std::string name;
  std::string material;
};

// One entry an object.
std::vector<ScenePart> scene_parts(const Scene& scene);

}  // namespace rayloc::draw
