// is_dead: true if the CSI of one receive chain holds no measurement: only zeros, one value at all
// tones, or a number that is not finite.
#pragma once

#include <complex>
#include <cstdint>
#include <span>

#include "engine/channel/csi_frame.h"

namespace rayloc {

bool is_dead(std::span<const std::complex<float>> row);

// True if the frame has a measurement of that receive chain, in its first stream.
bool brings_rx_chain(const CsiFrame& frame, std::uint8_t rx_chain);

}  // namespace rayloc
