// What one burst of a device at an unknown place says of the receive chains: for every state of a
// TurnGrid, how likely the burst is there, in the mean over the places where the device may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/likelihood/turned_likelihood.h"
#include "engine/localize/access_point_map.h"

namespace rayloc {

struct TurnEvidence {
  // [state]: ln of the weighted mean over the cells of exp(likelihood_exponent l), l above the
  // device being nowhere in particular.
  std::vector<double> log_evidence;

  // The cells where the device may be if the chains have turned by `phase` [rad], [chain].
  std::vector<std::size_t> cells_near(std::span<const double> phase) const;

  std::size_t turns = 0;                               // of a chain, in `best_cells`
  std::vector<std::vector<std::uint32_t>> best_cells;  // of every state of few turns
};

// `log_weight`: ln of how likely the device is in a cell, of sum 1.
// REQUIRES: the map has models (a Gaussian likelihood) and grid.chains() antennas.
TurnEvidence turn_evidence(const AccessPointMap& map,
                           const ObservedBurst& observed,
                           const TurnGrid& grid,
                           double likelihood_exponent,
                           std::span<const double> log_weight);
// [cell]: what an access point says of the place although nobody knows its chains: ln of the mean
// of exp(likelihood_exponent l) over the states, each as probable as stated, [state].
std::vector<double> places_whatever_turned(const AccessPointMap& map,
                                           const ObservedBurst& observed,
                                           const TurnGrid& grid,
                                           double likelihood_exponent,
                                           std::span<const double> probability);
// As turn_evidence(), of a device at a known place; nowhere: log-likelihood of what it is compared
// with.
TurnEvidence turn_evidence_at(const PlaceModel& place,
                              const ObservedArray& observed,
                              const TurnGrid& grid,
                              double likelihood_exponent,
                              double nowhere);

}  // namespace rayloc
