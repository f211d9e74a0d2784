// fit_person_certainty: the exponent of the likelihood with which the probabilities stated for a
// person's place are honest, and what a second person must explain to be believed, by
// cross-validation: every spot is judged by a model that was fitted without it.
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
  // PersonModel::second_person: the most that a second one explained where one stood, so that a
  // next spot exceeds it once in as many spots. Nothing from fewer than 20 spots.
  std::optional<double> second_person;
};

// `frames`: of each spot. The body is that of `fit`; everything else is fitted anew for each part.
Expected<PersonCertainty> fit_person_certainty(const RoomModel& room,
                                               const PersonFit& fit,
                                               std::span<const PersonSpot> spots,
                                               std::span<const std::vector<CsiFrame>> frames,
                                               const PersonFitOptions& options = {});

}  // namespace rayloc
