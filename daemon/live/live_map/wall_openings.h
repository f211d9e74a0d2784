// Doors and windows of a scene, for a plan with architects' symbols: a gap in the wall.
//
// An opening is upright, thin, cut at breast height, and named a door or a window; or it is of
// glass and does not reach the floor. The gap extends through the walls beside it or behind it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "daemon/site/plan/floor_plan.h"
#include "daemon/site/plan/scene_parts.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct WallOpening {
  bool is_door = false;  // otherwise a window
  std::uint32_t object = 0;
  // Corners of the gap, from the hinge along the side of the wall that faces the room.
  std::array<Vec3d, 4> corners;
};

// REQUIRES: plan = floor_plan(scene, parts).
std::vector<WallOpening> wall_openings(const std::vector<draw::ScenePart>& parts,
                                       const draw::FloorPlan& plan);

}  // namespace rayloc
