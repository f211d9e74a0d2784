// calibrate_jointly: fits a floor plan that is centimetres off to the measurements of all access
// points at once (METHODS B4).
//
// The rounds go from a high robust floor to a low one. Each first scans the surfaces one by one,
// the strongest first, because a wall that is 1 cm off is 2 cm of path, beyond the quarter wave
// that a descent can bridge. It then fits all released unknowns together, tries half waves to
// either side where the fit can distinguish them (wave_cycles.h), and traces the room anew. Points
// kept from the fit (not those held out by the caller) decide whether the result of a round is
// kept.
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

// State of a calibration between two rounds; sufficient to resume it.
struct JointCheckpoint {
  int rounds = 0;     // completed
  int last_kept = 0;  // last kept round, counted from 0
  JointState state;
  std::vector<ChainGains> gains;              // for each access point
  std::vector<WaveCycle> other_cycles;        // alternative surface offsets
  std::vector<CalibrationStep> history = {};  // steps so far
  double survey_sigma = 0.0;                  // [m], found so far; 0: not yet
};

struct JointCalibrationOptions {
  CalibrationPriors priors;
  bool finds_survey = false;  // and not priors.survey: the fit estimates the survey's accuracy
  TraceOptions trace{.max_depth = 4, .transmission = true};  // while fitting
  TraceOptions use{.max_depth = 3, .transmission = true};    // RoomModel::trace of the result
  int iterations = 12;                      // of the least squares in a round, at most
  std::uint64_t seed = 1;                   // for drawing the points that decide
  const JointCheckpoint* resume = nullptr;  // of the same room and points
  std::function<void(const JointCheckpoint&)> on_checkpoint;  // at the start, after each round
};

// The loss of its history is mean_unexplained() of the fitted points.
//
// `room`: the floor plan with the chain gains and the yaw of fit_access_point. Calibrates every
// access point that received a point. An Error names an access point with too few points.
Expected<RoomCalibration> calibrate_jointly(const RoomModel& room,
                                            std::span<const CalibrationPoint> points,
                                            const JointCalibrationOptions& options,
                                            const CalibrationObserver& observer);

}  // namespace rayloc
