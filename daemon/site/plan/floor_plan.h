// FloorPlan: a room in architectural style: cut at breast height and seen from above.
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/site/plan/face.h"
#include "daemon/site/plan/mesh_section.h"
#include "daemon/site/plan/scene_parts.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

struct FloorPlan {
  struct Cut {
    std::uint32_t object = 0;
    MeshSection section;
  };
  std::vector<Face> below;              // seen from above, lowest first
  std::vector<Cut> cuts;                // parts cut by the plane
  std::vector<std::uint32_t> overhead;  // objects above the cut, ceilings aside
};

// REQUIRES: parts = scene_parts(scene).
FloorPlan floor_plan(const Scene& scene, const std::vector<ScenePart>& parts);

}  // namespace rayloc::draw
