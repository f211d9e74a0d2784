// Limits of site.toml that its table of keys and its checks share.
#pragma once

namespace rayloc {

inline constexpr double kFarthest = 10'000.0;      // [m], coordinates: a larger one is an error
inline constexpr double kMaxAntennaOffset = 10.0;  // [m]

}  // namespace rayloc
