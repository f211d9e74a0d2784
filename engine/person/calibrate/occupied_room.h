// receive_background: the empty room as received by one access point, from a recording with walking
// people: for places that are never empty (METHODS B5: moving people need no empty room).
//
// A walking person adds a different and mostly small array to every frame; the room is the
// common part of the frames. The half of the frames that differ least from their mean is
// selected, repeatedly (least trimmed squares). A person who does not move throughout counts as
// furniture.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/observe/burst.h"
#include "engine/room/room_model.h"

namespace rayloc {

// As receive() of engine/room/preprocess_burst.h, for the frames that differ least.
std::optional<BurstObservation> receive_background(const RoomModel& room,
                                                   std::size_t access_point,
                                                   std::span<const CsiFrame> frames,
                                                   const BurstOptions& options,
                                                   std::vector<std::string>& warnings);

}  // namespace rayloc
