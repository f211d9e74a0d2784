// A full turn in radians, shared by the baselines.
#pragma once

#include <numbers>

namespace rayloc {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  // [rad]

}  // namespace rayloc
