// hear_background: the empty room as one access point hears it, from a recording in which people
// walk about: for places that are never empty (METHODS B5: moving people need no empty room).
//
// What a walker adds is another array in every frame and mostly small; the room is what the frames
// have in common. The half of the frames that differ least from their mean is taken, again and
// again (least trimmed squares). A person who stands still throughout counts as a piece of
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

// As hear() of engine/room/hear_burst.h, of the frames that differ least.
std::optional<BurstObservation> hear_background(const RoomModel& room,
                                                std::size_t access_point,
                                                std::span<const CsiFrame> frames,
                                                const BurstOptions& options,
                                                std::vector<std::string>& warnings);

}  // namespace rayloc
