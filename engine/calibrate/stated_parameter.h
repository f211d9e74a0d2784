// An unknown of the joint calibration as a person reads it: in its own unit instead of as a change.
#pragma once

#include "engine/calibrate/room_calibration.h"
#include "engine/calibrate/room_unknowns.h"

namespace rayloc {

// `room`: the original. Factors are stated as values of what they multiply, with the slope of the
// exponential for sigma.
RoomParameter stated_parameter(const Unknown& unknown,
                               const RoomModel& room,
                               double value,
                               double sigma);

}  // namespace rayloc
