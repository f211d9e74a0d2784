// Classifies an object by its dimensions: a picture shows floors,
// walls and furniture differently. Only pictures depend on this.
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

// One entry per object.
std::vector<ScenePart> scene_parts(const Scene& scene);

}  // namespace rayloc::draw
