// Bursts of a survey: the frames of each access point at each point, combined.
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct CombinedSurvey {
  std::vector<CalibrationPoint> points;  // one per row of the csv
  // By access point: why its first unusable burst was refused; empty: all bursts were usable.
  std::vector<std::string> first_refusal;
};

// `held`: true for held-out points. Unusable bursts are added to `inputs.refused`, by row of
// `points_file` and access point.
CombinedSurvey combine_survey(const RoomModel& room,
                              const std::vector<bool>& held,
                              const std::string& points_file,
                              CalibrationInputs& inputs);

}  // namespace rayloc
