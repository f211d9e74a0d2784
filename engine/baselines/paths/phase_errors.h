// How far phases are from where they should be: a Gaussian, and a share of outliers anywhere on the
// circle.
#pragma once

#include <span>

namespace rayloc {

struct PhaseErrors {
  double sigma = 0.45;     // [rad], standard deviation of those that are no outliers
  double outliers = 0.15;  // share
};

// By maximum likelihood. `errors`: [rad], wrapped. What stands above where there are fewer than 10.
PhaseErrors fit_phase_errors(std::span<const double> errors);

}  // namespace rayloc
