// SurveyedRoom: a furnished room as its plan says, the same room as built, and what its access
// points heard of a device on surveyed points: for tests and benchmarks of calibration, which must
// find the second from the first.
//
// The room as built is made from its own boxes, and every antenna is traced for itself: neither the
// unknowns of the calibration nor what it traces takes part.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/calibrate/room_calibration.h"
#include "engine/trace/trace_options.h"

namespace rayloc::test {

struct SurveyedRoomOptions {
  int points = 70;        // of them every fifth is held out
  int access_points = 1;  // up to 3
  int furniture = 3;      // boxes in the room, up to 8
  int tones = 58;         // of 40 MHz
  double error = 1.0;     // scale of everything in which plan and building differ; 0: nothing
  double survey = 0.005;  // [m], standard deviation of each axis
  double snr_db = 35.0;
  double plasterboard = 0.0;  // [m], how thick it is; 0: as in the table
  unsigned seed = 1;
  TraceOptions trace{.max_depth = 3};
};

struct SurveyedRoom {
  RoomModel plan;   // what the calibration starts from: equal gains of all chains
  RoomModel built;  // with the chain gains that the measured arrays have
  std::vector<CalibrationPoint> points;
  std::vector<Vec3d> survey_error;  // [m], of each point: where it was less where it is stated
  // By the names of parameter_id(): the truth of what differs, in the unit of RoomParameter; what
  // is not named is as planned.
  std::map<std::string, double> truth;
};

// 3.5 x 2.9 x 2.7 m: plasterboard and concrete walls up to 12 mm off the plan, arrays 4 mm and 1
// degree off, other permittivities, chains of different gains.
SurveyedRoom make_surveyed_room(const SurveyedRoomOptions& options = {});

}  // namespace rayloc::test
