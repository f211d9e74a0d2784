// summarise_filter: converts the filtered distribution of a target's position to an estimate.
#pragma once

#include <vector>

#include "engine/grid/cell_mass.h"
#include "engine/grid/grid.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

// Logarithms of masses; finite for a mass of zero.
std::vector<double> log_masses(std::vector<double> mass);

// Fills the same fields as summarise_posterior(). `grid`: grid of the room. `options`:
// cells_of_room is set here, and the mass outside the filter's window is added to the outlier
// probability. `within`: distribution of the position inside the best cells of the room.
void summarise_filter(const GridFilter& filter,
                      const Grid& grid,
                      PosteriorOptions options,
                      const RefinedCells& within,
                      LocationEstimate& location);

}  // namespace rayloc
