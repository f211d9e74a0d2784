// dead_chains_of: finds the receive chains of a survey that delivered
// nothing or noise, to which a calibration would fit gains.
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// One line per chain: the access point, the rx chain, and what
// to do; empty: none found. `points`: from combine_survey().
std::string dead_chains_of(const RoomModel& room,
                           const std::vector<CalibrationPoint>& points,
                           const CalibrationInputs& inputs);

}  // namespace rayloc
