// dead_chains_of: the receive chains of a survey that brought nothing, or noise: a calibration
// would fit gains to it.
#pragma once

#include <string>
#include <vector>

#include "daemon/calibrate/calibration_inputs.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

// A line for each: the access point, the core, and what to do; empty: none. `points`: of
// combine_survey().
std::string dead_chains_of(const RoomModel& room,
                           const std::vector<CalibrationPoint>& points,
                           const CalibrationInputs& inputs);

}  // namespace rayloc::cli
