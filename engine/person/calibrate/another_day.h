// Change of one array between two days: people were recorded on one, and are located on the other
// (METHODS B5). A power cycle has changed the chains, a person has moved a chair; the fixed
// transmitter, the room and the effect of a person are the same.
//
//   y2 = t_m (y1 + change),   one complex factor t_m per chain, one delay for all
//
// The empty rooms of both days are measured, so the traced room is not used. A factor for every
// tone would attribute changes of the room to a chain: the ripple of the chains' filters outlasts a
// power cycle, and the change differs at every tone. It is strongest where the room is in a fade;
// such tones have less weight (iteratively reweighted least squares).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

struct RotatedChains {
  std::vector<std::complex<double>> turn;  // per chain; the first is real, their mean square 1
  std::vector<double> sigma;               // [rad], of the phase of each
  double changed = 0.0;  // share of the power that differs after correction of the chains

  // True if a power cycle lies between: phases differ by more than changes of the room explain.
  bool is_rotated() const;
};

// For one array on two days, [rx_chain][tone], as delivered by the chains, antenna coupling
// included. An Error when they have so little in common that it is another transmitter, place or
// radio. REQUIRES: sizes equal and a multiple of the grid's.
Expected<RotatedChains> compare_days(const OfdmGrid& grid,
                                     const std::vector<std::complex<double>>& before,
                                     const std::vector<std::complex<double>>& after);

// `gains` after the change of the chains; and gains before a change that resulted in `gains`.
ChainGains rotated(ChainGains gains, const RotatedChains& chains);
ChainGains derotated(ChainGains gains, const RotatedChains& chains);

}  // namespace rayloc
