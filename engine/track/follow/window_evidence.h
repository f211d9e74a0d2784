// Evidence of the whole room, for a filter that compared earlier moments with a window of it.
#pragma once

#include <span>
#include <vector>

#include "engine/grid/cell_window.h"
#include "engine/grid/grid.h"

namespace rayloc {

// Shares of a snapshot's weight that a moment counts.
struct MomentWeights {
  double window = 0.0;  // between cells of the window, which earlier moments were compared with
  double room = 0.0;    // between the window and the other cells: at least `window`
};

// Log-likelihoods [cell] for one update with `weights.room`. Compared with the other cells, the
// window as a whole has the mean likelihood of its cells, and between its cells the moment counts
// `weights.window`. `prior`: probability [cell]. `exponent`: that of the likelihood.
// REQUIRES: exponent > 0, weights.room > 0.
std::vector<double> tempered_in_window(std::vector<double> log_likelihood,
                                       std::span<const double> prior,
                                       const CellWindow& window,
                                       const Grid& grid,
                                       double exponent,
                                       const MomentWeights& weights);

}  // namespace rayloc
