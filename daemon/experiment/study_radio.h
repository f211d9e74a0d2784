// The radios of a study's access points: their chains as the model has them, and frames of what
// they recorded.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "daemon/simulate/capture_simulator.h"
#include "engine/channel/csi_frame.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Before each chain was multiplied by its change, if any was.
ChainGains before_changes(ChainGains gains, const std::vector<std::complex<double>>& changes);

// The gains on the tones of `grid`, all of which they have.
ChainGains gains_on_grid(const ChainGains& all, const OfdmGrid& grid);

// Of rooms on several channels the position of that whose channel is nearest to the model's.
std::size_t nearest_channel(std::span<const RoomModel> rooms, const RoomModel& model);

// As the product's receiver makes them, of any channel.
std::vector<CsiFrame> decoded_frames(const SpotCapture& capture,
                                     const RoomAccessPoint& ap,
                                     int index);

}  // namespace rayloc
