// Plots of a comparison, written by `rayloc evaluate --plot`.
#pragma once

#include <filesystem>

#include "daemon/lab/evaluate/comparison.h"

namespace rayloc {

// Writes cdf.svg, coverage.svg, reliability.svg and, for a comparison with a site, map.svg.
// REQUIRES: the directory exists.
Expected<void> write_comparison_plots(const std::filesystem::path& directory,
                                      const Comparison& comparison);

}  // namespace rayloc
