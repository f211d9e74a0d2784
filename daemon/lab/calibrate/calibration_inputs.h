// Measurements of a calibration: recordings split by the points of a survey.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Frames of all access points received while the device was at one surveyed point.
struct SurveyedFrames {
  SurveyPoint point;
  std::vector<CsiFrame> frames;  // by access point, then by time
};

struct CalibrationInputs {
  std::vector<SurveyedFrames> points;  // one per row of the csv
  std::vector<bool> recorded;          // by access point of the site
  std::vector<RefusedInput> refused;
  std::vector<std::string> notes;  // notes of the recordings: for_each_frame()
  std::string content;             // hash of the content of recordings and points
  std::string points_hash;
};

// Returns the site with the bounds of its room; if it states none, with those of the scene.
Site with_bounds(Site site, const RoomModel& room);

// Reads the points and the recordings, of which an access point may have several. Only frames of
// one device count, the same for the whole survey: a device that the site lists, if it lists any.
// The clocks of the access points may differ by `kClockSlack`. Errors name the row or the access
// point: a point outside the room (`site.bounds_min`, `bounds_max`, if present) or at the time of
// another, a recording without the device, one that shares no time with the points, or points that
// clearly fit it at another time (survey_clock.h). `time_offset` is added to the times of the
// points; if it is stated, no other offset is searched unless no point has frames.
// check_calibration_inputs() checks that recordings and positions fit together.
Expected<CalibrationInputs> read_calibration_inputs(const Site& site,
                                                    const std::vector<CaptureArgument>& captures,
                                                    const std::string& points_file,
                                                    std::optional<Duration> time_offset = {});

}  // namespace rayloc
