// A full turn, as the baselines write it.
#pragma once

#include <numbers>

namespace rayloc {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  // [rad]

}  // namespace rayloc
