// calibrate_from_draws: runs a joint calibration (joint_calibration.h) several times and returns
// the best result.
//
// The points that decide are drawn at random, and a step that one draw refuses is accepted in
// another: runs end in rooms that differ by millimetres, and occasionally with a wall in another
// half-wave cycle. The best run is the one whose room explains the fitted points best, each at its
// best place within the survey's error; held-out points have no influence.
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_calibration.h"

namespace rayloc {

// Default number of runs of a calibration: more than one where that takes about half a minute,
// depending on the number of bursts.
int usual_draws(std::span<const CalibrationPoint> points);

// Draw number i has options.seed + i. Checkpoints are of the first run, which is the one that
// resumes from `options.resume`; if a later run is interrupted, the best result so far is returned
// and marked as interrupted. The history is that of the best run. REQUIRES: draws > 0.
Expected<RoomCalibration> calibrate_from_draws(const RoomModel& room,
                                               std::span<const CalibrationPoint> points,
                                               const JointCalibrationOptions& options,
                                               int draws,
                                               const CalibrationObserver& observer);

// Mean over the points that are not held out of the logarithm of the share left unexplained at the
// best place; lower is better.
double left_unexplained(std::span<const CalibrationPoint> points,
                        const RoomCalibration& calibration);

}  // namespace rayloc
