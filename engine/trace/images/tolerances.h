// Rounding tolerances of decisions about images and mirrors.
#pragma once

namespace rayloc {

// Closer to a mirror's plane than this, a point is on it and has no reflection there [m].
inline constexpr double kMinPlaneDistance = 1e-9;
// Single precision decides within this share of the largest coordinate: some 30 roundings, where a
// plane equation has 7.
inline constexpr float kSingleRounding = 2e-6F;

}  // namespace rayloc
