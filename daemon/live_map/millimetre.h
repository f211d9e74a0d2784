// Lengths as the page gets them: what is finer nobody sees, and it would be sent all the same.
#pragma once

#include <cmath>

namespace rayloc {

// [m], to the nearest millimetre.
inline double to_millimetre(double metres) { return std::round(metres * 1000.0) / 1000.0; }

}  // namespace rayloc
