// RoomMap: joint log-likelihoods of all access points for every cell of a room.
#pragma once

#include <span>
#include <vector>

#include "engine/grid/cell_mass.h"
#include "engine/posterior/access_point_fusion.h"

namespace rayloc {

struct RoomMap {
  std::vector<double> log_likelihood;  // [cell]
  RefinedCells within;                 // of the refined cells
  std::vector<std::vector<double>>
      fault_probability;  // [access point][cell], probability that it is wrong
};

// maps: [access point][cell], the maps of `fusion`. No cell is refined.
RoomMap fuse(std::span<const std::vector<double>> maps, const AccessPointFusion& fusion);

// For each access point the probability that its observation is uninformative.
std::vector<double> fault_probabilities(const RoomMap& map, double likelihood_exponent);

}  // namespace rayloc
