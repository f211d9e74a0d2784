// fit_person_certainty: exponent of the likelihood that makes the reported probabilities of a
// person's place valid, and required gain of a second person, by cross-validation: every point is
// tested with a model that was fitted without it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/person/calibrate/person_fit.h"

namespace rayloc {

struct PersonCertainty {
  double likelihood_exponent = 0.35;
  // PersonModel::second_person: the largest gain of a second person over points with one person, so
  // that a next point exceeds it once in as many points. nullopt from fewer than 20 points.
  std::optional<double> second_person;
};

// `frames`: per point. The body is that of `fit`; everything else is fitted anew for each part.
Expected<PersonCertainty> fit_person_certainty(const RoomModel& room,
                                               const PersonFit& fit,
                                               std::span<const PersonPoint> points,
                                               std::span<const std::vector<CsiFrame>> frames,
                                               const PersonFitOptions& options = {});

}  // namespace rayloc
