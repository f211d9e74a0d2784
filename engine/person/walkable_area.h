// WalkableArea: the places of a room that a person can occupy: not in a wall, not in a cupboard and
// not on a table. Chairs and other small, low objects are not obstacles: people move them, or sit
// on them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/grid/grid.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct WalkableArea {
  Grid grid;                       // on the floor
  std::vector<std::uint8_t> free;  // 1: a person fits at the middle of the cell
};

// Cells of `step` over the part of the room's bounds within the square about `area`. If no cell
// would be free, the plan is ignored and all cells are free.
WalkableArea make_walkable_area(const RoomModel& room,
                                const TargetBody& body,
                                const std::optional<PersonArea>& area,
                                double step);

}  // namespace rayloc
