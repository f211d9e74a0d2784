// An unknown of the joint calibration as reported to users: a value in its own unit, not a change.
#pragma once

#include <complex>
#include <cstddef>

#include "engine/calibrate/joint/room_unknowns.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

// `room`: the original. A factor is reported as the value of the quantity it multiplies, with sigma
// from the slope of the exponential.
RoomParameter stated_parameter(const Unknown& unknown,
                               const RoomModel& room,
                               double value,
                               double sigma);

// The mean gain of a chain over the tones, relative to the first chain's.
std::complex<double> chain_ratio(const ChainGains& gains, std::size_t element);

// A chain's gain [dB] or phase [deg] relative to the first: its value in `found` and, as prior, in
// `assumed`, about which the unknown has its own prior. Phases are next to the assumed ones.
RoomParameter stated_chain(const Unknown& unknown,
                           const RoomModel& room,
                           const ChainGains& assumed,
                           const ChainGains& found,
                           double sigma);

}  // namespace rayloc
