// draw_holdout: which points of a survey are kept from the fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rayloc {

// A share of them, drawn without replacement; the same for each access point and for the same seed.
std::vector<bool> draw_holdout(std::size_t count, double share, std::uint64_t seed);

}  // namespace rayloc
