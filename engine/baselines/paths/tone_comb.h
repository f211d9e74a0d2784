// ToneComb: tones of a channel that are equally spaced on both sides of its centre, as required by
// methods that shift a window along the tones. The unused tones around DC would leave a gap in any
// other choice.
//
// At 40 MHz these are +-2, +-6, ... +-58: the 30 tones that the Intel 5300 reports.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

struct ToneComb {
  std::vector<std::size_t> tone;  // positions in the grid, ascending
  double step_hz = 0.0;           // from one to the next
};

// Tones +-s/2, +-3s/2, ... with the least s of 2, 4, 8, ... that gives at most 32; empty if the
// channel has no such tones.
ToneComb tone_comb(const OfdmGrid& grid);

}  // namespace rayloc
