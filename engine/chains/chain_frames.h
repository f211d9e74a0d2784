// Frames as the chains of an access point give them.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Multiplies what each chain heard by its factor, [chain]; other chains are left alone.
void multiply(const RoomAccessPoint& ap,
              const std::vector<std::complex<double>>& factors,
              CsiFrame& frame);

// The first frames of a burst, in which somebody who walks moves by less than half a wavelength:
// over a whole burst the arrays of different places would be averaged.
std::span<const CsiFrame> first_moment(std::span<const CsiFrame> frames);

}  // namespace rayloc
