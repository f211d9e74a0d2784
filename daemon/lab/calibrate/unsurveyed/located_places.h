// Estimates positions of devices in recordings of an
// unsurveyed site, as points for a calibration of its walls.
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct LocatedPlaces {
  std::vector<SurveyPoint> points;  // ordered by time, at most about two hundred
  double sigma = 0.0;               // [m], along each axis, median of the reported sigmas
  std::size_t bursts = 0;           // bursts located to find the points
};

// Bursts of devices with a reliable position: one hypothesis, and a decimetre at most. `site`: with
// known chains. `notes` as in for_each_frame().
Expected<LocatedPlaces> located_places(const Site& site,
                                       const RoomModel& room,
                                       const std::vector<CaptureArgument>& captures,
                                       std::vector<std::string>& notes);

// In the format of load_points_csv().
std::string to_csv(const std::vector<SurveyPoint>& points);

}  // namespace rayloc
