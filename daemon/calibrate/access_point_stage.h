// The first and the last step of every calibration: the chain gains of each access point, its yaw
// and how far the model of the room may be off, from the points of a survey.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/access_point_fit.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct AccessPointResult {
  std::size_t index = 0;
  AccessPointFit fit;          // on all points
  AccessPointFit train;        // without those held out
  std::vector<PointFit> fits;  // of all points, with `train`; before: equal gains, surveyed yaw
  std::vector<TransmitterLevel> levels = {};
};

// A floor plan is centimetres off: beside that no error of a survey shows.
inline constexpr double kExactSurvey = 0.0;

// Of the access point with that index. survey_error: of the points, standard deviation on each axis
// [m]. An Error names it where too few points heard it.
Expected<AccessPointResult> fit_access_point(const RoomModel& room,
                                             std::size_t access_point,
                                             std::span<const CalibrationPoint> points,
                                             double survey_error,
                                             ArrayFit array);

// The access point as a fit has it.
void apply(const AccessPointFit& fit, RoomAccessPoint& access_point);

}  // namespace rayloc
