// Lengths as sent to the page: finer resolution would be invisible and cost bandwidth.
#pragma once

#include <cmath>

namespace rayloc {

// [m], to the nearest millimetre.
inline double to_millimetre(double metres) { return std::round(metres * 1000.0) / 1000.0; }

}  // namespace rayloc
