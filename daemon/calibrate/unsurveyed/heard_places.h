// Where devices were while they were recorded, as far as a site that nobody surveyed tells: points
// for a calibration of its walls.
#pragma once

#include <string>
#include <vector>

#include "daemon/arguments/capture_argument.h"
#include "daemon/site/site.h"
#include "daemon/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

struct HeardPlaces {
  std::vector<SurveyPoint> points;  // in order of time, at most some two hundred
  double sigma = 0.0;               // [m], along each axis, median of what their estimates state
  std::size_t bursts = 0;           // that were located for them
};

// Bursts of devices whose place is sure: one hypothesis, and a decimetre at most. `site`: with
// chains that are known. `notes` as of for_each_frame().
Expected<HeardPlaces> heard_places(const Site& site,
                                   const RoomModel& room,
                                   const std::vector<CaptureArgument>& captures,
                                   std::vector<std::string>& notes);

// As load_points_csv() reads them.
std::string to_csv(const std::vector<SurveyPoint>& points);

}  // namespace rayloc::cli
