// ChainGains: complex gain of the receive chains of an access point relative to the field at its
// antennas, per chain and tone; constant from one power cycle to the next.
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

// Standard deviation of the change of a chain's ln |gain| in a power cycle.
inline constexpr double kChainGainSigma = 0.17;  // of ln, 1.5 dB

struct ChainGains {
  OfdmGrid grid;
  std::vector<std::uint8_t> rx_chains;
  std::vector<std::complex<double>> gain;  // [rx_chain][tone], mean square 1
  // Mutual coupling of the antennas before the gains, the same at all tones: [rx_chain][rx_chain],
  // the factor of each field in a core's signal, 1 for its own. Empty: none.
  std::vector<std::complex<double>> coupling;

  bool empty() const { return gain.empty(); }
};

// Applies the mutual coupling in place. REQUIRES: h is [rx_chain][any].
void apply_coupling(const ChainGains& gains, std::span<std::complex<double>> h);

// Computes the field at the antennas in place: h / gain, 0 where a chain is dead, coupling removed.
// REQUIRES: h is [rx_chain][tone] as the gains are; no field couples as much to another core.
void remove_gains(const ChainGains& gains, std::span<std::complex<double>> h);

}  // namespace rayloc
