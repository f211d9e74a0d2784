// Evidence of one burst, from a device at an unknown place, on the receive chains: the likelihood
// of the burst for every state of a RotationGrid, averaged over the places where the device may be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/likelihood/rotated_likelihood.h"
#include "engine/localize/access_point_map.h"

namespace rayloc {

struct TurnEvidence {
  // [state]: ln of the weighted mean over the cells of exp(likelihood_exponent l), where l is the
  // log-likelihood relative to the null model.
  std::vector<double> log_evidence;

  // The cells where the device may be if the chains have phase offsets `phase` [rad], [chain].
  std::vector<std::size_t> cells_near(std::span<const double> phase) const;

  std::size_t turns = 0;                               // phases per chain in `best_cells`
  std::vector<std::vector<std::uint32_t>> best_cells;  // for each state of the coarse grid
};

// `log_weight`: ln of the probability that the device is in a cell; the probabilities sum to 1.
// REQUIRES: the map has models (a Gaussian likelihood) and grid.chains() antennas.
TurnEvidence turn_evidence(const AccessPointMap& map,
                           const ObservedBurst& observed,
                           const RotationGrid& grid,
                           double likelihood_exponent,
                           std::span<const double> log_weight);
// [cell]: evidence of an access point with unknown chains on the place: ln of the mean of
// exp(likelihood_exponent l) over the states, weighted by `probability`, [state].
std::vector<double> places_for_any_rotation(const AccessPointMap& map,
                                            const ObservedBurst& observed,
                                            const RotationGrid& grid,
                                            double likelihood_exponent,
                                            const std::vector<double>& probability);
// The same for several probabilities of the states at once: [probability][cell]. REQUIRES: one or
// more.
std::vector<std::vector<double>> places_for_rotations(
    const AccessPointMap& map,
    const ObservedBurst& observed,
    const RotationGrid& grid,
    double likelihood_exponent,
    std::span<const std::vector<double>> probabilities);
// As turn_evidence(), for a device at a known place. `null_model`: log-likelihood of the null
// model, the reference of the comparison.
TurnEvidence turn_evidence_at(const PlaceModel& place,
                              const ObservedArray& observed,
                              const RotationGrid& grid,
                              double likelihood_exponent,
                              double null_model);

}  // namespace rayloc
