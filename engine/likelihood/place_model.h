// PlaceModel: distribution of the measurement when the device stands at one place, as
// ObservationModel makes it.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

namespace rayloc {

// The inverse Cholesky factor W of Sigma, and W mu.
struct PlaceModel {
  std::vector<std::complex<float>> whitener;  // lower triangle by rows
  std::vector<std::complex<float>> mean;      // W mu; behind it, where there is one, W mu_covered
  // |W mu|^2 and |Sigma^-1 mu|^2 of these.
  struct Powers {
    float whitened = 0.0F;
    float inverse = 0.0F;
  };
  Powers open;
  Powers covered;
  float log_determinant = 0.0F;  // of Sigma
  float noise = 0.0F;            // n; 0: Sigma has that of the burst, too
  bool reachable = false;        // there is a ray
};

// Probability that a direct way is covered, before anything is heard.
inline constexpr double kCovered = 0.02;
inline const double kLogCovered = std::log(kCovered);  // [nat]

}  // namespace rayloc
