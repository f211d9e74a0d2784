// Frames as delivered by the receive chains of an access point.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/chains/chain_state.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Multiplies the samples of each chain by its factor, [chain]; other chains are not changed.
void multiply(const RoomAccessPoint& ap,
              const std::vector<std::complex<double>>& factors,
              CsiFrame& frame);

// Removes the factors of an access point's chains from its frames; other frames are not changed.
void undo(const ChainState& state, const RoomAccessPoint& ap, std::span<CsiFrame> frames);

// The first frames of a burst, during which a walking person moves by less than half a wavelength:
// the mean over a whole burst would mix the arrays of different places.
std::span<const CsiFrame> first_moment(std::span<const CsiFrame> frames);

}  // namespace rayloc
