// RoomMap: what the access points together say of every cell of a room.
#pragma once

#include <span>
#include <vector>

#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/posterior.h"

namespace rayloc {

struct RoomMap {
  std::vector<double> log_likelihood;      // [cell]
  KnownCells within;                       // of those looked at closely
  std::vector<std::vector<double>> doubt;  // [access point][cell], that it is wrong there
};

// maps: [access point][cell], those that `fusion` is of. No cell is looked at closely.
RoomMap fuse(std::span<const std::vector<double>> maps, const AccessPointFusion& fusion);

// Of each access point the probability that what it hears says nothing of the place.
std::vector<double> doubts(const RoomMap& map, double likelihood_exponent);

}  // namespace rayloc
