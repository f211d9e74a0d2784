// calibrate_jointly: from a floor plan that is centimetres off to a room that explains what was
// measured (METHODS B4), for all access points at once.
//
// Rounds from a high robust floor to a low one. In each, the surfaces are scanned one by one, the
// strongest first, because a wall that is 1 cm off is 2 cm of path, beyond the quarter wave that a
// descent can bridge; then all unknowns that the round releases are fitted together; then, where
// the fit is good enough to tell, half waves to either side are tried (wave_cycles.h); then the
// room is traced anew. Points kept from the fit (not those held out by the caller) decide whether
// what a round released stays.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_problem.h"
#include "engine/calibrate/joint/joint_rounds.h"
#include "engine/calibrate/joint/room_unknowns.h"
#include "engine/calibrate/joint/wave_cycles.h"
#include "engine/calibrate/room_calibration.h"

namespace rayloc {

// Where a calibration stands between two rounds; all that is needed to go on.
struct JointCheckpoint {
  int rounds = 0;     // done
  int last_kept = 0;  // of them, counted from 0
  JointState state;
  std::vector<ChainGains> gains;              // of each access point
  std::vector<WaveCycle> other_cycles;        // what else surfaces could be
  std::vector<CalibrationStep> history = {};  // that led here
  double survey_sigma = 0.0;                  // [m], found so far; 0: nothing is
};

struct JointCalibrationOptions {
  CalibrationPriors priors;
  bool finds_survey = false;  // and not priors.survey: the fit finds how exact the survey is
  TraceOptions trace{.max_depth = 4, .transmission = true};  // while fitting
  TraceOptions use{.max_depth = 3, .transmission = true};    // RoomModel::trace of the result
  int iterations = 12;                      // of the least squares in a round, at most
  std::uint64_t seed = 1;                   // of the draw of the points that decide
  const JointCheckpoint* resume = nullptr;  // of the same room and points
  std::function<void(const JointCheckpoint&)> on_checkpoint;  // at the start, after each round
};

// The loss of its history is mean_unexplained() of the points that are fitted.
//
// `room`: the floor plan with the chain gains and the yaw of fit_access_point. Every access point
// that heard something is calibrated. An Error names an access point with too few points.
Expected<RoomCalibration> calibrate_jointly(const RoomModel& room,
                                            std::span<const CalibrationPoint> points,
                                            const JointCalibrationOptions& options,
                                            const CalibrationObserver& observer);

}  // namespace rayloc
