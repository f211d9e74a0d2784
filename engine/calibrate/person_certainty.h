// fit_person_certainty: the exponent of the likelihood with which the probabilities stated for a
// person's place are honest, by cross-validation: every spot is judged by a model that was fitted
// without it.
#pragma once

#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/calibrate/person_fit.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// `frames`: of each spot. The body is that of `fit`; everything else is fitted anew for each part.
Expected<double> fit_person_certainty(const RoomModel& room,
                                      const PersonFit& fit,
                                      std::span<const PersonSpot> spots,
                                      std::span<const std::vector<CsiFrame>> frames,
                                      const PersonFitOptions& options = {});

}  // namespace rayloc
