// calibrate_from_draws: a joint calibration (joint_calibration.h) begun several times, of which the
// best stays.
//
// Which points decide is drawn, and a step that one draw refuses another takes: runs end in rooms
// that differ by millimetres, and now and then with a wall in another half-wave cycle. The run
// whose room meets the points best that were fitted, each where it fits best within the survey's
// error, is the best of them; points held out have no say.
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/calibrate/joint/joint_calibration.h"

namespace rayloc {

// How often a calibration is begun unless told: more than once where that takes half a minute or
// so, by the number of bursts.
int usual_draws(std::span<const CalibrationPoint> points);

// Draw number i has options.seed + i. Checkpoints are of the first run, which is the one that goes
// on from `options.resume`; where a later one is interrupted the best so far is returned, as
// interrupted. The history is that of the best. REQUIRES: draws > 0.
Expected<RoomCalibration> calibrate_from_draws(const RoomModel& room,
                                               std::span<const CalibrationPoint> points,
                                               const JointCalibrationOptions& options,
                                               int draws,
                                               const CalibrationObserver& observer);

// Mean over the points that are not held out of the logarithm of the share left unexplained at the
// best place: the less the better.
double left_unexplained(std::span<const CalibrationPoint> points,
                        const RoomCalibration& calibration);

}  // namespace rayloc
