// ParameterChange: how far a parameter moved from where it was assumed, and what the data say of
// it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/calibrate/room_calibration.h"

namespace rayloc {

struct ParameterChange {
  RoomParameter parameter;
  double by = 0.0;                     // value - prior
  std::optional<double> prior_sigmas;  // |by| of the prior's; absent where nothing was assumed
  // Why the value is not to be trusted, or empty: "not bounded by the data", "known no better than
  // before", "several half-wave cycles possible", "beyond three sigmas of what was assumed".
  std::string caution;
};

// Those that moved most of their prior's sigmas first, then those without a prior.
//
// A reflection repeats when its surface moves by half a wavelength, so an offset whose posterior
// is wider than a uniform one over half a wavelength is not known to its cycle. `wavelength` [m].
std::vector<ParameterChange> parameter_changes(const std::vector<RoomParameter>& parameters,
                                               double wavelength);

}  // namespace rayloc
