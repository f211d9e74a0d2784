// refine_chains: the complex factors of receive chains that have turned, from bursts of devices at
// unknown places, once it is known roughly how they have turned.
//
// The factors maximise the sum over the bursts of ln sum_places exp(t l(factors)) with the prior
// that levels stay about as they were. A burst that no place explains with these factors counts as
// little as one that is of no place: the sum of each has a floor.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/turned_likelihood.h"

namespace rayloc {

// A burst at the places where it may be from.
struct PlacedBurst {
  std::vector<ChainMoments> places;
  std::vector<double> log_weight;  // [place], ln of how likely the device is there
  double floor = 0.0;  // of ln sum exp(t l + log_weight) over its places: it may be of none of them
};

// What a chain multiplies by, beside what the calibration says.
struct ChainFactors {
  std::vector<std::complex<double>>
      factor;                       // [chain]; the first has no phase, all a mean level of 1
  std::vector<double> sigma;        // [rad], of each phase against the first's
  std::vector<double> level_sigma;  // of ln |factor|
  double log_evidence = 0.0;        // of the bursts, refined; to compare starts

  static ChainFactors unity(std::size_t chains);
};

// REQUIRES: bursts not empty, of as many chains as `start`.
ChainFactors refine_chains(std::span<const PlacedBurst> bursts,
                           const std::vector<std::complex<double>>& start,
                           double likelihood_exponent);

}  // namespace rayloc
