// Physical constants, SI units. The only place where they are written.
#pragma once

namespace rayloc {

inline constexpr double kSpeedOfLight = 299'792'458.0;              // [m/s], exact
inline constexpr double kVacuumPermittivity = 8.854'187'812'8e-12;  // [F/m], CODATA 2018

}  // namespace rayloc
