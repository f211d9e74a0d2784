// Selects the strongest rays of a place, which keep their mean. All others contribute their power
// to the covariance.
//
// Thread safety: functions of their arguments.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/likelihood/observation_model.h"
#include "engine/likelihood/place_moments.h"

namespace rayloc {

// Indices of the largest powers, largest first: at least one, at most `most`, until the others have
// at most `left_out` of the sum.
std::vector<std::size_t> strongest(std::span<const double> power,
                                   std::size_t most,
                                   double left_out);

struct KnownRays {
  // Indices, strongest first; the ray that may be obstructed is moved to the front.
  std::vector<std::size_t> rays;
  bool has_direct = false;  // such a ray is among them
};

// At most `most`, until the others have at most `left_out` of the known power. REQUIRES: terms of
// this place.
KnownRays known_rays(const ObservationModel& model,
                     const ObservationModel::Place& place,
                     const ObservationModel::RayTerms& terms,
                     std::size_t most,
                     double left_out);

// Share of the power of each ray that is not in the mean: the unknown part, and the known part of
// those that are not in `known`.
std::vector<double> unknown_shares(const ObservationModel::RayTerms& terms, const KnownRays& known);

// Second moment about the mean, with unknown_shares(). Sets sigma and diffuse; the mean is zero.
PlaceMoments unknown_moments(const ObservationModel& model,
                             const ObservationModel::Place& place,
                             const ModelError& error,
                             const ObservationModel::RayTerms& terms,
                             const KnownRays& known);

}  // namespace rayloc
