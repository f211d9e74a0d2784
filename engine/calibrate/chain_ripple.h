// Residual response of the receive chains beyond the known part: the principal direction of
// measured over expected arrays, smooth over the tones (METHODS B4, step 1).
#pragma once

#include <complex>
#include <vector>

#include "engine/observe/alignment.h"

namespace rayloc {

struct ArrayPair {
  std::vector<std::complex<double>> measured;  // [rx_chain][tone]
  std::vector<std::complex<double>> expected;
};

struct ChainRipple {
  std::vector<std::complex<double>> gain;  // [rx_chain][tone], mean square 1
  std::vector<double> sigma;               // [rad], of the phase of each core
};

// measured ~ gain * expected, up to a factor and a delay of each pair.
// REQUIRES: pairs not empty, all of one size.
ChainRipple chain_ripple(const Aligner& aligner,
                         const OfdmGrid& grid,
                         std::vector<ArrayPair> pairs);

}  // namespace rayloc
