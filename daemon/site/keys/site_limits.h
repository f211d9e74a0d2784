// Limits of site.toml that its table of keys and its checks share.
#pragma once

namespace rayloc {

inline constexpr double kFarthest = 10'000.0;      // [m], of a coordinate: beyond it is a slip
inline constexpr double kMaxAntennaOffset = 10.0;  // [m]

}  // namespace rayloc
