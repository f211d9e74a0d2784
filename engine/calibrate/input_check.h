// check_calibration_inputs: whether a survey was made the way it was stated, before anything is
// fitted to it.
//
// Recordings and places that do not belong together still have a best fit; only it is a bad one.
// What was stated is therefore compared with the mistakes that surveys are known for, under the
// floor plan and the chain gains alone (AccessPointCalibrator::fit_gains()), which each hypothesis
// fits for itself. What is compared is the squared normalised correlation of each point, in pairs:
// a room that is modelled badly is so under both hypotheses.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/localize/room_model.h"

namespace rayloc {

// A point that should not enter the fit.
struct PointRefusal {
  std::size_t point = 0;
  std::string reason;  // "fits its place by 0.04 (ap1) where the others fit by 0.71: ..."
};

// An Error where a mistake explains the survey clearly better than what was stated; it names the
// one that does so most clearly: x and y exchanged, an axis that runs the other way, the room
// turned by half a turn, rows one off, or the recording of another access point. Else the points
// that fit far worse than all others (misfitting_points()), of what was traced in the room as it
// is.
//
// "Clearly": the mean of the paired differences exceeds kClearly of its standard errors. Were a
// mistake as good as the truth, that happens once in 740 comparisons; for a right survey the mean
// is negative. With fewer than kLeastPairs pairs of a point and an access point nothing is said.
//
// `room`: the uncalibrated one. Points that no ray reaches are left out of the comparison.
// REQUIRES: every h of a point is empty or has as many values as its access point has cores x
// tones.
constexpr double kClearly = 3.0;
constexpr std::size_t kLeastPairs = 12;
Expected<std::vector<PointRefusal>> check_calibration_inputs(
    const RoomModel& room, std::span<const CalibrationPoint> points);

// Points whose PointFit::`share` lies far below those of the others at the same access points: on
// the scale log(c / (1 - c)), by more than kFarBelow robust standard deviations (1.4826 times the
// median absolute deviation, and an allowance for its own error), taken together over the access
// points that heard the point. Nothing where fewer than kLeastPairs points were heard.
constexpr double kFarBelow = 3.5;
std::vector<PointRefusal> misfitting_points(const RoomModel& room,
                                            std::span<const PointFit> fits,
                                            double PointFit::*share);

}  // namespace rayloc
