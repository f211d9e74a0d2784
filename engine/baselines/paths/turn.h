// Phases on the circle.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace rayloc {

// exp(j phase).
inline std::complex<double> turn(double phase) { return std::polar(1.0, phase); }

// The phase [rad] wrapped to half a turn about 0.
inline double wrapped(double phase) { return std::remainder(phase, 2.0 * std::numbers::pi); }

}  // namespace rayloc
