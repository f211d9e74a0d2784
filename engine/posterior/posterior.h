// Posterior: the position and uncertainty given by a map of log-likelihoods over a room's cells.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// Cells of equal size over the room at one height, x outermost.
struct RoomGrid {
  Vec3d first;                // [m], centre of cell (0, 0)
  double height_sigma = 0.0;  // [m], of a target about that height; 0: known height
  double step_x = 0.0;
  double step_y = 0.0;
  std::size_t count_x = 0;
  std::size_t count_y = 0;

  // Covers the bounds with cells of about `step`.
  RoomGrid(const Vec3d& bounds_min, const Vec3d& bounds_max, double height, double step);

  std::size_t size() const { return count_x * count_y; }
  Vec3d centre(std::size_t cell) const {
    const std::size_t x = cell / count_y;
    const std::size_t y = cell % count_y;
    return {first.x + step_x * static_cast<double>(x),
            first.y + step_y * static_cast<double>(y),
            first.z};
  }
};

// Distribution inside a cell: the mean's offset from the centre [m] and the covariance.
struct CellMoments {
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;  // [m^2]
  double xy = 0.0;
  double yy = 0.0;
  double z = 0.0;  // for a target at an unknown height
  double xz = 0.0;
  double yz = 0.0;
  double zz = 0.0;
};
// Uniform distribution in the cell.
CellMoments uniform_moments(const RoomGrid& grid);

// Distributions of all of a cell's mass, and of the part around its best place.
struct CellMass {
  CellMoments all;
  CellMoments best;
  double best_share = 1.0;
  std::vector<float> layers = {};  // share of each of HeightLayers; empty: known height
};

// Cells with a known inner distribution; all others are uniform.
using KnownCells = std::vector<std::pair<std::size_t, CellMass>>;

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
};

// Sets position, covariance, accuracy, hypotheses, residual probability and `ambiguous` of the
// estimate. Hypotheses are the peaks of the map; the heaviest one is split into core and foot
// (two_component_split.h) if it consists of two and there is room for one more. The position is in
// the smallest disc with half of the mass (smallest_half_mass_disc.h), which need not contain the
// heaviest peak; in it, the maximum of the mass in a 0.1 m kernel, not the highest cell: a spike is
// more often wrong than a broad peak. Without a position, `reason` states that the map is flat.
void summarise_posterior(const RoomGrid& grid,
                         const std::vector<double>& log_likelihood,
                         const PosteriorOptions& options,
                         LocationEstimate& estimate,
                         const KnownCells& within = {});

}  // namespace rayloc
