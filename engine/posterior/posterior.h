// Posterior: the position and uncertainty given by a map of log-likelihoods over a room's cells.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/grid/cell_mass.h"
#include "engine/grid/grid.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct PosteriorOptions {
  double likelihood_exponent = 1.0;  // exponent of the likelihood
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  // Outlier probability: the map carries no information on the position.
  double outlier = 0.0;
  double sigma_floor = 0.01;  // [m], added to the width of the map (RoomModel::sigma_floor)
  // Number of cells of the room, if the grid is a part of it that holds all but `outlier` of the
  // mass; 0: the grid is the whole room.
  double cells_of_room = 0.0;
  // Largest share of the room's cells that the map may cover (by its entropy): with more it is flat
  // and gives no position.
  double max_spread = 0.5;
  // Further factor of the exponent for the reported covariance, accuracy and hypotheses; the
  // position does not depend on it.
  double region_exponent = 1.0;
};

// Sets position, covariance, accuracy, hypotheses, residual probability and `ambiguous` of the
// estimate. Hypotheses are the peaks of the map; the heaviest one is split into core and foot
// (two_component_split.h) if it consists of two and there is room for one more. The position is in
// the smallest disc with half of the mass (smallest_half_mass_disc.h), which need not contain the
// heaviest peak; in it, the maximum of the mass in a 0.1 m kernel, not the highest cell: a spike is
// more often wrong than a broad peak. Without a position, `reason` states that the map is flat.
void summarise_posterior(const Grid& grid,
                         const std::vector<double>& log_likelihood,
                         const PosteriorOptions& options,
                         LocationEstimate& estimate,
                         const RefinedCells& within = {});

// Number of equally probable cells that have the entropy of `mass`, whose sum is 1.
double effective_cells(std::span<const double> mass);

}  // namespace rayloc
