// The rays of a place that keep their mean: the strongest ones. The power of all others is unknown.
//
// Thread safety: functions of their arguments.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "engine/likelihood/observation_model.h"
#include "engine/likelihood/place_moments.h"

namespace rayloc {

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

// a_p s_p of a ray before the factor of its known part, [antenna][coordinate of one].
Eigen::VectorXcd array_of(const ObservationModel& model,
                          const ObservationModel::Place& place,
                          const ObservationModel::RayTerms& terms,
                          std::size_t p);

// Second moment about the mean: the unknown part of each ray, and the known part of those that are
// not in `known`. Sets sigma and diffuse; the mean is zero.
PlaceMoments unknown_moments(const ObservationModel& model,
                             const ObservationModel::Place& place,
                             const ModelError& error,
                             const ObservationModel::RayTerms& terms,
                             const KnownRays& known);

}  // namespace rayloc
