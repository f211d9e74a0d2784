// What `rayloc evaluate --plot` writes of a comparison.
#pragma once

#include <filesystem>

#include "daemon/evaluate/comparison.h"

namespace rayloc {

// cdf.svg, coverage.svg, reliability.svg and, of a comparison with a site, map.svg.
// REQUIRES: the directory exists.
Expected<void> write_comparison_plots(const std::filesystem::path& directory,
                                      const Comparison& comparison);

}  // namespace rayloc
