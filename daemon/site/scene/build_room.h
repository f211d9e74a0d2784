// build_room: converts a RoomPlan to the scene that load_scene reads.
#pragma once

#include "daemon/site/scene/room_plan.h"
#include "daemon/site/scene/scene_files.h"

namespace rayloc {

// Objects, in this order: the six sides of the room, or floors and ceilings of rooms with an
// outline; walls, the openings that have a material, the boxes.
//
// A side is a sheet at the inner face of the wall, its normal inwards: one
// slab of the material's thickness for both directions of crossing. A box
// has six faces, each such a slab; with one size of 0 it is a sheet as well.
StatedScene build_room(const RoomPlan& plan);

// Twelve triangles, normals outwards; two if one size is 0.
Mesh box_mesh(const PlanBox& box);

}  // namespace rayloc
