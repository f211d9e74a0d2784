// Physical constants and units of angles, SI, defined only here.
#pragma once

#include <numbers>

namespace rayloc {

inline constexpr double kSpeedOfLight = 299'792'458.0;              // [m/s], exact
inline constexpr double kVacuumPermittivity = 8.854'187'812'8e-12;  // [F/m], CODATA 2018

inline constexpr double kDegree = std::numbers::pi / 180.0;            // [rad]
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;  // [deg/rad]

}  // namespace rayloc
