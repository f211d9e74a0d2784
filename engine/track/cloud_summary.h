// summarise_cloud: converts a cloud of weighted places to an estimate of the position.
#pragma once

#include <cstddef>
#include <span>

#include "engine/base/vec3.h"
#include "engine/grid/grid.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

// Counts, chosen: cells of a summary that have any mass, and all of its cells, about. They bound
// its time: a wide cloud, or hills far apart, get larger cells.
inline constexpr std::size_t kSummaryCells = 200;
inline constexpr std::size_t kSummaryWindow = 1000;

// Fills the fields that summarise_posterior() fills. grid: of the room. inside:
// SearchArea::inside, empty if all cells are. options: likelihood_exponent and cells_of_room are
// set here, and the mass outside the area or the grid is added to options.outlier. Returns that
// mass, a probability; without any other mass, location.reason states it and there is no position.
// If no place is possible, the result is 1.
double summarise_cloud(const PlaceCloud& cloud,
                       const Grid& grid,
                       std::span<const char> inside,
                       PosteriorOptions options,
                       LocationEstimate& location);

// The cells in which a summary is made: a part of the room's grid with all but 1e-4 of the mass,
// or larger cells over the same part. weights: of each place, 0 for places that are left out.
// REQUIRES: a weight above 0 in the grid.
Grid summary_grid(const PlaceCloud& cloud, std::span<const float> weights, const Grid& grid);

// Mean velocity [m/s] of the places within 0.15 m of a position, in plan; of all if there are
// none.
Vec3d velocity_of(const PlaceCloud& cloud, const Vec3d& position);

}  // namespace rayloc
