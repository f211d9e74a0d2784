// Doors and windows of a scene, for a plan that draws them as architects do: a gap in the wall.
//
// An opening is upright, thin, cut at breast height, and called a door or a window; or it is of
// glass and does not reach the floor. The gap goes through the walls beside it or behind it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "daemon/draw/floor_plan.h"
#include "daemon/draw/scene_parts.h"
#include "engine/base/vec3.h"

namespace rayloc {

struct WallOpening {
  bool is_door = false;  // else a window
  std::uint32_t object = 0;
  // Of the gap, from the hinge along the side of the wall where the room is.
  std::array<Vec3d, 4> corners;
};

// REQUIRES: plan = floor_plan(scene, parts).
std::vector<WallOpening> wall_openings(const std::vector<draw::ScenePart>& parts,
                                       const draw::FloorPlan& plan);

}  // namespace rayloc
