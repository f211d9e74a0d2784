// The antennas of an access point that are usable for a bearing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/baselines/paths/bearing.h"
#include "engine/observe/burst.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Antennas with live chains (dead_chain()), if there are at least two on a line of equal steps;
// otherwise empty, with a warning that states the reason.
std::optional<AntennaLine> living_line(const RoomAccessPoint& access_point,
                                       const BurstObservation& burst,
                                       std::vector<std::string>& warnings);

// [antenna of the line][tone of `tones`], tones by their positions in the burst's grid.
Eigen::MatrixXcd along(const AntennaLine& line,
                       const BurstObservation& burst,
                       const std::vector<std::size_t>& tones);

}  // namespace rayloc
