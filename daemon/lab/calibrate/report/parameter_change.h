// ParameterChange: change of a parameter from its
// assumed value, and how well the data constrain it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/calibrate/room_calibration.h"

namespace rayloc {

struct ParameterChange {
  RoomParameter parameter;
  double by = 0.0;                     // value - prior
  std::optional<double> prior_sigmas;  // |by| in sigmas of the prior; absent without a prior
  // Why the value is not reliable, or empty: "not bounded by the data", "known no better than
  // before", "several half-wave cycles possible", "beyond three sigmas of what was assumed".
  std::string caution;
};

// Ordered by the change in prior sigmas, largest first, then those without a prior.
//
// A reflection repeats when its surface moves by half a wavelength, so an offset whose posterior is
// wider than a uniform one over half a wavelength has an ambiguous cycle. `wavelength` [m].
std::vector<ParameterChange> parameter_changes(const std::vector<RoomParameter>& parameters,
                                               double wavelength);

}  // namespace rayloc
