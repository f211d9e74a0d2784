// Initial calibration of an unsurveyed site: its plan, with the usual errors of plans.
#pragma once

#include "daemon/site/model/calibration_file.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Access points are at their positions in the plan, the phases of
// their chains are unknown, and the errors of the model are those of
// a floor plan (ModelError). REQUIRES: a room without a calibration.
CalibrationFile plan_calibration(const RoomModel& plan);

}  // namespace rayloc
