// PlaceModel: distribution of the measurement for a device at one place, as computed by
// ObservationModel.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

namespace rayloc {

// The inverse Cholesky factor W of Sigma, and W mu.
struct PlaceModel {
  std::vector<std::complex<float>> whitener;  // lower triangle by rows
  std::vector<std::complex<float>> mean;      // W mu; followed by W mu_obstructed if it exists
  // |W mu|^2 and |Sigma^-1 mu|^2 of these means.
  struct Powers {
    float whitened = 0.0F;
    float inverse = 0.0F;
  };
  Powers open;
  Powers obstructed;
  float log_determinant = 0.0F;  // of Sigma
  float noise = 0.0F;            // n; 0: Sigma includes the burst's noise
  bool reachable = false;        // at least one ray exists
};

// Prior probability that a line of sight is obstructed.
inline constexpr double kObstructed = 0.02;
inline const double kLogObstructed = std::log(kObstructed);  // [nat]

}  // namespace rayloc
