// ArrayObservation: a burst received by one access point, with the access point's map.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "engine/likelihood/likelihood.h"
#include "engine/localize/access_point_map.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

// A burst received by one access point, chain gains removed.
struct ArrayObservation {
  std::size_t ap = 0;                   // index among the access points that the localizer can use
  const AccessPointMap* map = nullptr;  // map for the working antennas; owned by the localizer
  ObservedBurst observed;
  std::vector<std::complex<double>> h;  // [antenna][tone], up to one complex factor and one delay
  std::vector<double> power_log_likelihood;  // [cell], of AccessPointMap; empty: none

  // To be added to the log-likelihood before tempering by `likelihood_exponent`: the exponent
  // describes the model error of h, while the spread of received powers was measured.
  double power_log_likelihood_at(std::size_t cell, double likelihood_exponent) const {
    return power_log_likelihood.empty() || likelihood_exponent <= 0.0
               ? 0.0
               : power_log_likelihood[cell] / likelihood_exponent;
  }
};

// A burst received by the access points of the room.
struct RoomObservation {
  std::vector<ArrayObservation>
      arrays;                 // for one Localizer; empty: nothing usable, see estimate.reason
  LocationEstimate estimate;  // times, counts and warnings, no position
};

}  // namespace rayloc
