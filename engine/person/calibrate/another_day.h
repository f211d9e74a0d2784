// What lies between two days of one array: people were recorded on one, and are looked for on the
// other (METHODS B5). A power cycle has turned the chains, somebody has moved a chair; the fixed
// transmitter, the room and what a person does are the same.
//
//   y2 = t_m (y1 + what moved),   one complex factor t_m a chain, one delay for all
//
// The empty rooms of both days are measured, so nothing of the traced room enters. A factor of
// every tone would take what moved for a chain: the ripple of the chains' filters stays over a
// power cycle, and what moved is different at every tone. It is strongest where the room is in a
// fade; such tones count less (iteratively reweighted least squares).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

struct TurnedChains {
  std::vector<std::complex<double>> turn;  // of each chain; the first is real, their mean square 1
  std::vector<double> sigma;               // [rad], of the phase of each
  double changed = 0.0;  // share of the power that differs although the chains are known

  // Whether a power cycle lies between: phases differ by more than what moved explains.
  bool is_turned() const;
};

// Of one array on two days, [core][tone], as the chains have it: with what the antennas take from
// each other. An Error when they have so little in common that it is another transmitter, place or
// radio. REQUIRES: sizes equal and a multiple of the grid's.
Expected<TurnedChains> compare_days(const OfdmGrid& grid,
                                    const std::vector<std::complex<double>>& before,
                                    const std::vector<std::complex<double>>& after);

// Gains of chains that have these, and then turn; and of those that did turn and have these.
ChainGains turned(ChainGains gains, const TurnedChains& chains);
ChainGains turned_back(ChainGains gains, const TurnedChains& chains);

}  // namespace rayloc
