// An unknown of the joint calibration as a person reads it: in its own unit instead of as a change.
#pragma once

#include <complex>
#include <cstddef>

#include "engine/calibrate/joint/room_unknowns.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

// `room`: the original. Factors are stated as values of what they multiply, with the slope of the
// exponential for sigma.
RoomParameter stated_parameter(const Unknown& unknown,
                               const RoomModel& room,
                               double value,
                               double sigma);

// The mean gain of a chain over the tones, as a factor on the first chain's.
std::complex<double> chain_ratio(const ChainGains& gains, std::size_t element);

// A chain's gain [dB] or phase [deg] against the first: its value in `found` and, as prior, in
// `assumed`, about which the unknown has its own prior. Phases are next to the assumed ones.
RoomParameter stated_chain(const Unknown& unknown,
                           const RoomModel& room,
                           const ChainGains& assumed,
                           const ChainGains& found,
                           double sigma);

}  // namespace rayloc
