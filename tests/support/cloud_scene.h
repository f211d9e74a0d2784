// Rooms whose devices are followed by clouds of places.
#pragma once

#include <memory>

#include "engine/localize/localizer.h"
#include "engine/room/room_model.h"
#include "engine/track/cloud_room.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::test {

// make_room() with a cupboard, devices at unknown heights.
RoomModel furnished_room();

// Traces the room: takes a second.
std::shared_ptr<const CloudRoom> cloud_room(RoomModel room, const LocalizerOptions& options = {});

}  // namespace rayloc::test
