// PlaceModel: distribution of the measurement for a device at one place, as computed by
// ObservationModel.
#pragma once

#include <cmath>

#include "engine/likelihood/gaussian/whitened_gaussian.h"

namespace rayloc {

// Its means are W mu, followed by W mu_obstructed if it exists. The logarithm of the determinant is
// rounded to single precision, as the sums that it is subtracted from.
struct PlaceModel : WhitenedGaussian {
  // |W mu|^2 and |Sigma^-1 mu|^2 of these means.
  struct Powers {
    float whitened = 0.0F;
    float inverse = 0.0F;
  };
  Powers open = {};
  Powers obstructed = {};
  float noise = 0.0F;      // n; 0: Sigma includes the burst's noise
  bool reachable = false;  // at least one ray exists
};

// Prior probability that a line of sight is obstructed.
inline constexpr double kObstructed = 0.02;
inline const double kLogObstructed = std::log(kObstructed);  // [nat]

}  // namespace rayloc
