// What is known of a site that nobody surveyed: its plan, and how far plans are usually off.
#pragma once

#include "daemon/site/calibration_file.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Access points stand where the plan says, nobody knows the phases of their chains, and the
// errors of the model are those of a floor plan (ModelError). REQUIRES: a room without a
// calibration.
CalibrationFile plan_calibration(const RoomModel& plan);

}  // namespace rayloc
