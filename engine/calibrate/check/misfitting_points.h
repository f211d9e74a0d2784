// misfitting_points: points of a survey that fit far worse than all others.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A point that should be excluded from the fit.
struct PointRefusal {
  std::size_t point = 0;
  std::string reason;  // "fits its place by 0.04 (ap1) where the others fit by 0.71: ..."
};

// Points whose PointFit::`share` lies far below those of the others at the same access points: on
// the scale log(c / (1 - c)), by more than kFarBelow robust standard deviations (1.4826 times the
// median absolute deviation, and an allowance for its own error), combined over the access points
// that received the point. Empty where fewer than kMinPairs points were received.
constexpr double kFarBelow = 3.5;
std::vector<PointRefusal> misfitting_points(const RoomModel& room,
                                            std::span<const PointFit> fits,
                                            double PointFit::*share);

}  // namespace rayloc
