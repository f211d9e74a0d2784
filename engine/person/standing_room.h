// StandingRoom: the places of a room where a person can stand: not in a wall, not in a cupboard and
// not on a table. Chairs and what else is small and low is no obstacle: people move it, or sit on
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/person/person_reference.h"
#include "engine/posterior/posterior.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct StandingRoom {
  RoomGrid grid;                   // on the floor
  std::vector<std::uint8_t> free;  // 1: a person can stand in the middle of the cell
};

// Cells of `step` over the bounds of the room and the square about `area`. When nothing would be
// free the plan is not believed, and everything is.
StandingRoom make_standing_room(const RoomModel& room,
                                const TargetBody& body,
                                const std::optional<PersonArea>& area,
                                double step);

}  // namespace rayloc
