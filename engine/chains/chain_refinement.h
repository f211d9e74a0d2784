// refine_chains: complex factors of receive chains with changed phases, from bursts of devices at
// unknown places, starting from a rough estimate of the change.
//
// The factors maximise the sum over the bursts of ln sum_places exp(t l(factors)), with the prior
// that amplitudes stay about the same. A burst that no place explains with these factors has as
// little weight as one that matches no place at all: each sum has a floor.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/rotated_likelihood.h"

namespace rayloc {

// A burst with its candidate places.
struct PlacedBurst {
  std::vector<ChainMoments> places;
  std::vector<double> log_weight;  // [place], ln of the probability that the device is there
  double floor = 0.0;  // of ln sum exp(t l + log_weight) over the places: the device may be at none
};

// Complex gains of the chains relative to the calibration.
struct ChainFactors {
  std::vector<std::complex<double>> factor;  // [chain]; first phase 0, mean ln |factor| 0
  std::vector<double> sigma;                 // [rad], of each phase relative to the first
  std::vector<double> log_gain_sigma;        // of ln |factor|
  double log_evidence = 0.0;                 // of the bursts, refined; to compare starts

  static ChainFactors unity(std::size_t chains);
};

// REQUIRES: bursts not empty, of as many chains as `start`.
ChainFactors refine_chains(std::span<const PlacedBurst> bursts,
                           const std::vector<std::complex<double>>& start,
                           double likelihood_exponent);

}  // namespace rayloc
