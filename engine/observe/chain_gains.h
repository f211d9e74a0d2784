// ChainGains: what the receive chains of an access point do to the field at its antennas, per chain
// and tone; constant from one power cycle to the next.
//
// Only ratios between chains and the shape over the tones matter: one common complex factor and one
// common delay are undetermined, as in every burst.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

struct ChainGains {
  OfdmGrid grid;
  std::vector<std::uint8_t> cores;
  std::vector<std::complex<double>> gain;  // [core][tone], mean square 1

  bool empty() const { return gain.empty(); }
};

// h / gain in place, 0 where a chain is dead. REQUIRES: h is [core][tone] as the gains are.
void remove_gains(const ChainGains& gains, std::span<std::complex<double>> h);

}  // namespace rayloc
