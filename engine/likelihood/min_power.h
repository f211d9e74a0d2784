// The minimum power that likelihoods divide by.
#pragma once

namespace rayloc {

inline constexpr double kMinPower = 1e-12;        // a ratio, chosen: keeps divisions from zero
inline constexpr float kMinSinglePower = 1e-12F;  // as kMinPower, in single precision

}  // namespace rayloc
