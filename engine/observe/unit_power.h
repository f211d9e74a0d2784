// Scaling of arrays without an absolute power to mean square 1.
#pragma once

#include <cmath>
#include <complex>
#include <vector>

namespace rayloc {

// An array of zeros is unchanged.
inline void scale_to_unit(std::vector<std::complex<double>>& values) {
  double power = 0.0;
  for (const auto& v : values) {
    power += std::norm(v);
  }
  if (power > 0.0) {
    const double scale = std::sqrt(static_cast<double>(values.size()) / power);
    for (auto& v : values) {
      v *= scale;
    }
  }
}

}  // namespace rayloc
