// hand_over: a cloud of places drawn from a grid filter, and a grid filter made of a cloud.
//
// Cells are handed over with their moments, not hypotheses: a device at rest whose place is
// determined to a centimetre keeps it. Everything follows from the arguments alone.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/normal_draws.h"
#include "engine/grid/cell_mass.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

// `count` places of equal weight, drawn from the cells and modes of the window in equal steps of
// the mass. In a cell of `within` (cells of the room) they have its moments, those of the best
// place and of the rest, and the heights of its layers; in any other cell they are evenly
// distributed, and `layers` has the probabilities of the heights (empty: the prior). Walking places
// have the velocity of their mode. No place is behind a wall of its cell.
// REQUIRES: `space` is that of the filter, !filter.is_compact().
PlaceCloud cloud_of(const GridFilter& filter,
                    const FreeSpace& space,
                    const RefinedCells& within,
                    std::span<const double> layers,
                    std::size_t count,
                    NormalDraws& draws);

// The reverse: the masses of cells, and of the walking mode nearest in velocity, evenly of several
// that are about as near. `elsewhere`: share of the mass, in [0, 1], that is spread over all free
// cells and modes; so is all of it if no place is in a free cell.
GridFilter grid_of(const PlaceCloud& cloud,
                   std::shared_ptr<const FreeSpace> space,
                   const MotionModel& motion,
                   double elsewhere);
// Probability of each layer of heights of a grid; empty at a known height or without any weight.
std::vector<double> layers_of(const PlaceCloud& cloud, const Grid& grid);

}  // namespace rayloc
