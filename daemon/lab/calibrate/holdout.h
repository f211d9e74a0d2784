// draw_holdout: selects the points of a survey that are held out from the fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayloc {

// Draws a share without replacement; the same points for each access point and for the same seed.
std::vector<bool> draw_holdout(std::size_t count, double share, std::uint64_t seed);

}  // namespace rayloc
