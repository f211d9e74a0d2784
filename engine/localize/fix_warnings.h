// Warnings of a fix about the access points that it uses.
#pragma once

#include <vector>

#include "engine/localize/array_observation.h"
#include "engine/posterior/room_map.h"
#include "engine/room/location_estimate.h"
#include "engine/room/ray.h"

namespace rayloc {

using RaysOfEach = std::vector<std::vector<Ray>>;  // rays to the position of a fix, [array]

// Adds warnings of access points that contradict the others, and of obstructed lines of sight.
// `map`: map of the fix.
void warn_of_suspects(const std::vector<ArrayObservation>& received,
                      const RoomMap& map,
                      double likelihood_exponent,
                      const RaysOfEach& rays,
                      LocationEstimate& estimate);

}  // namespace rayloc
