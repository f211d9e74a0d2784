// HeardArray: a burst as an access point heard it, beside the map of what it expects.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "engine/likelihood/likelihood.h"
#include "engine/localize/access_point_map.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// A burst as one access point heard it, its chain gains removed.
struct HeardArray {
  std::size_t ap = 0;                   // number among the access points that the localizer can use
  const AccessPointMap* map = nullptr;  // of the antennas that work; the localizer's
  ObservedBurst observed;
  std::vector<std::complex<double>> h;  // [antenna][tone], up to one complex factor and one delay
  std::vector<double> level;  // [cell], AccessPointMap::level_log_likelihood(); empty: none

  // To add to what is then raised to the power of `likelihood_exponent`: that is of how well h is
  // modelled, and the spread of levels was measured.
  double level_at(std::size_t cell, double likelihood_exponent) const {
    return level.empty() || likelihood_exponent <= 0.0 ? 0.0 : level[cell] / likelihood_exponent;
  }
};

// A burst as the access points of the room heard it.
struct RoomObservation {
  std::vector<HeardArray> arrays;  // of one Localizer; empty: nothing usable, see estimate.reason
  LocationEstimate estimate;       // times, counts and warnings, no position
};

}  // namespace rayloc
