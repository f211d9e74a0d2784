// summarise_filter: what a filter knows of a target's place, as an estimate.
#pragma once

#include <vector>

#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

// Of masses; finite where there is none.
std::vector<double> log_masses(std::vector<double> mass);

// Fills what summarise_posterior() fills. `grid`: of the room. `options`: cells_of_room is set
// here, and what is out of the filter's window joins the outlier. `within`: where in the best cells
// of the room.
void summarise_filter(const GridFilter& filter,
                      const RoomGrid& grid,
                      PosteriorOptions options,
                      const KnownCells& within,
                      LocationEstimate& location);

}  // namespace rayloc
