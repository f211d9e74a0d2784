// The antennas of an access point that a bearing can be taken from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/baselines/paths/bearing.h"
#include "engine/observe/burst.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Those whose chains are alive (dead_chain()), where they are two or more on a line of equal steps;
// else the reason is a warning.
std::optional<AntennaLine> living_line(const RoomAccessPoint& access_point,
                                       const BurstObservation& burst,
                                       std::vector<std::string>& warnings);

// [antenna of the line][tone of `tones`], tones by their positions in the burst's grid.
Eigen::MatrixXcd along(const AntennaLine& line,
                       const BurstObservation& burst,
                       const std::vector<std::size_t>& tones);

}  // namespace rayloc
