// Radios of a study's access points: their chains in the
// model, and the frames decoded from their recordings.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "daemon/lab/simulate/capture_simulator.h"
#include "engine/channel/csi_frame.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The gains before the multiplicative change of each chain, if there was one.
ChainGains before_changes(ChainGains gains, const std::vector<std::complex<double>>& changes);

// The gains on the tones of `grid`, which must include all of them.
ChainGains gains_on_grid(const ChainGains& all, const OfdmGrid& grid);

// Among rooms on several channels, the index of the one with the channel nearest the model's.
std::size_t nearest_channel(std::span<const RoomModel> rooms, const RoomModel& model);

// Frames of any channel, decoded by the product's receiver.
std::vector<CsiFrame> decoded_frames(const PointCapture& capture,
                                     const RoomAccessPoint& ap,
                                     std::size_t index);

}  // namespace rayloc
