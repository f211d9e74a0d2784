// Posterior: what a map of log-likelihoods over the cells of a room says about the position.
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
  double height_sigma = 0.0;  // [m], of a target about that height; 0: it is known
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

// Where in a cell its mass is: the mean's offset from the centre [m] and the covariance about it.
struct CellMoments {
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;  // [m^2]
  double xy = 0.0;
  double yy = 0.0;
  double z = 0.0;  // of a target at an unknown height
  double xz = 0.0;
  double yz = 0.0;
  double zz = 0.0;
};
// Anywhere in the cell.
CellMoments uniform_moments(const RoomGrid& grid);

// The same of all of its mass, and of the part that lies about its best place.
struct CellMass {
  CellMoments all;
  CellMoments best;
  double best_share = 1.0;
  std::vector<float> layers = {};  // share of each of HeightLayers; empty: the height is known
};

// Cells of which that is known; in all others the mass is anywhere.
using KnownCells = std::vector<std::pair<std::size_t, CellMass>>;

struct PosteriorOptions {
  double likelihood_exponent = 1.0;  // exponent of the likelihood
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  // Probability that the map says nothing of the place: left over, whatever the map says.
  double outlier = 0.0;
  double least_sigma = 0.01;  // [m], added to what the map says (RoomModel::least_sigma)
  // Of the room, where the grid is a part of it that holds all but `outlier` of the mass; 0: the
  // grid is all of it.
  double cells_of_room = 0.0;
};

// Fills position, covariance, accuracy, hypotheses, residual probability and `ambiguous` of the
// estimate. Hypotheses are the hills of the map; of the heaviest, where there is room for one more,
// core and foot (two_component_split.h) where these are two. The position is where half of the mass
// is near (smallest_half_mass_disc.h), which need not be the heaviest hill; in there the maximum of
// the mass in a kernel of 0.1 m, not the highest cell: a spike is more often wrong than a hill.
// Without a position, `reason` says that the map is flat.
void summarise_posterior(const RoomGrid& grid,
                         const std::vector<double>& log_likelihood,
                         const PosteriorOptions& options,
                         LocationEstimate& estimate,
                         const KnownCells& within = {});

}  // namespace rayloc
