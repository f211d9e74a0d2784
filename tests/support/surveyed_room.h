// SurveyedRoom: a furnished room as planned, the same room as built, and the CSI that its access
// points receive from a device on surveyed points: for tests and benchmarks of calibration, which
// must estimate the built room from the plan.
//
// The room as built is made from its own boxes, and every antenna is traced separately: it uses
// neither the unknowns nor the traced paths of the calibration.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/calibrate/room_calibration.h"
#include "engine/trace/trace_options.h"

namespace rayloc::test {

struct SurveyedRoomOptions {
  int points = 70;        // of which every fifth is held out
  int access_points = 1;  // up to 3
  int furniture = 3;      // boxes in the room, up to 8
  int tones = 58;         // of 40 MHz
  double error = 1.0;     // scale of all differences between plan and building; 0: none
  double survey = 0.005;  // [m], standard deviation of each axis
  double snr_db = 35.0;
  double plasterboard = 0.0;  // [m], its thickness; 0: as in the table
  unsigned seed = 1;
  TraceOptions trace{.max_depth = 3};
};

struct SurveyedRoom {
  RoomModel plan;   // the initial state of the calibration: equal gains of all chains
  RoomModel built;  // with the chain gains of the measured arrays
  std::vector<CalibrationPoint> points;
  std::vector<Vec3d> survey_error;  // [m], of each point: true minus stated position
  // By the names of parameter_id(): the true values of what differs, in the unit of RoomParameter;
  // parameters that are not listed are as planned.
  std::map<std::string, double> truth;
};

// 3.5 x 2.9 x 2.7 m: plasterboard and concrete walls up to 12 mm off the plan, arrays 4 mm and 1
// degree off, other permittivities, chains of different gains.
SurveyedRoom make_surveyed_room(const SurveyedRoomOptions& options = {});

}  // namespace rayloc::test
