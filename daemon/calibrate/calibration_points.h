// The bursts of a survey: what each access point heard at each point, its frames combined.
#pragma once

#include <string>
#include <vector>

#include "daemon/calibrate/calibration_inputs.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct CombinedSurvey {
  std::vector<CalibrationPoint> points;  // one a row of the csv
  // Of each access point: why the first of its bursts could not be used; empty: all could.
  std::vector<std::string> first_refusal;
};

// `held`: whether each point is held out. Bursts that cannot be used stand in `inputs.refused`
// then, by row of `points_file` and access point.
CombinedSurvey combine_survey(const RoomModel& room,
                              const std::vector<bool>& held,
                              const std::string& points_file,
                              CalibrationInputs& inputs);

}  // namespace rayloc::cli
