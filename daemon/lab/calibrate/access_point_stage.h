// First and last step of every calibration: fits each access point's chain gains, yaw and room
// model errors to the points of a survey.
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
  AccessPointFit fit;          // fit to all points
  AccessPointFit train;        // fit without the held-out points
  std::vector<PointFit> fits;  // all points, by `train`; before: equal gains, surveyed yaw
  std::vector<TransmitterPower> powers = {};
};

// A floor plan is centimetres off; survey errors are negligible beside that.
inline constexpr double kExactSurvey = 0.0;

// Fits the access point with that index. survey_error: standard deviation of the points on each
// axis [m]. Returns an Error that names the access point if too few points were observed.
Expected<AccessPointResult> fit_access_point(const RoomModel& room,
                                             std::size_t access_point,
                                             std::span<const CalibrationPoint> points,
                                             double survey_error,
                                             ArrayFit array);

// Writes the fitted values into the access point.
void apply(const AccessPointFit& fit, RoomAccessPoint& access_point);

}  // namespace rayloc
