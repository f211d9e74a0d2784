#include "engine/track/follow/window_evidence.h"

#include <algorithm>
#include <cmath>

namespace rayloc {

std::vector<double> tempered_in_window(std::vector<double> log_likelihood,
                                       std::span<const double> prior,
                                       const CellWindow& window,
                                       const Grid& grid,
                                       double exponent,
                                       const MomentWeights& weights) {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double whole = 0.0;  // sums over the window: of the mass with all of the moment's weight,
  double part = 0.0;   // of the mass with the window's own weight,
  double mass = 0.0;   // and of the mass before
  for (std::size_t n = 0; n < window.size(); ++n) {
    const std::size_t cell = window.cell(n, grid);
    const double value = exponent * (log_likelihood[cell] - top);
    whole += prior[cell] * std::exp(value);
    part += prior[cell] * std::exp(weights.window * value);
    mass += prior[cell];
  }
  if (whole <= 0.0) {  // the likelihoods of the window are zero, and remain so
    return log_likelihood;
  }
  // An update with the returned values gives the window (whole / mass)^weights.room.
  const double level = weights.room * std::log(whole / mass) - std::log(part / mass);
  for (std::size_t n = 0; n < window.size(); ++n) {
    double& value = log_likelihood[window.cell(n, grid)];
    value = top + (level / exponent + weights.window * (value - top)) / weights.room;
  }
  return log_likelihood;
}

}  // namespace rayloc
