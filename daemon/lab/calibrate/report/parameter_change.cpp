#include "daemon/lab/calibrate/report/parameter_change.h"

#include <algorithm>
#include <cmath>

namespace rayloc {
namespace {

// Share of the prior's sigma above which a posterior adds no information.
constexpr double kNoBetter = 0.9;
constexpr double kFar = 3.0;  // prior sigmas

std::string caution_of(const ParameterChange& change, double wavelength) {
  const RoomParameter& parameter = change.parameter;
  if (!(parameter.sigma > 0.0)) {
    return "not bounded by the data";
  }
  const double cycle_sigma = 0.5 * wavelength / std::sqrt(12.0);
  if (parameter.id.quantity == Quantity::kSurfaceOffset && parameter.sigma > cycle_sigma) {
    return "several half-wave cycles possible";
  }
  if (parameter.prior_sigma > 0.0 && parameter.sigma >= kNoBetter * parameter.prior_sigma) {
    return "known no better than before";
  }
  if (change.prior_sigmas.value_or(0.0) > kFar) {
    return "beyond three sigmas of what was assumed";
  }
  return "";
}

}  // namespace

std::vector<ParameterChange> parameter_changes(const std::vector<RoomParameter>& parameters,
                                               double wavelength) {
  std::vector<ParameterChange> changes;
  for (const RoomParameter& parameter : parameters) {
    ParameterChange change;
    change.parameter = parameter;
    change.by = parameter.value - parameter.prior;
    if (parameter.prior_sigma > 0.0) {
      change.prior_sigmas = std::abs(change.by) / parameter.prior_sigma;
    }
    change.caution = caution_of(change, wavelength);
    changes.push_back(std::move(change));
  }
  std::stable_sort(changes.begin(), changes.end(), [](const auto& a, const auto& b) {
    return a.prior_sigmas.value_or(-1.0) > b.prior_sigmas.value_or(-1.0);
  });
  return changes;
}

}  // namespace rayloc
