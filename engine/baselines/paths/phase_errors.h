// Model of phase errors: a Gaussian, and a share of outliers that are uniform on the
// circle.
#pragma once

#include <span>

namespace rayloc {

struct PhaseErrors {
  double sigma = 0.45;     // [rad], standard deviation of inliers
  double outliers = 0.15;  // share
};

// By maximum likelihood. `errors`: [rad], wrapped. The defaults above for fewer than 10.
PhaseErrors fit_phase_errors(std::span<const double> errors);

}  // namespace rayloc
