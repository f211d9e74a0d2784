// The text of `rayloc top`: a pure function of the model and the time.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/cli/feed/top_model.h"
#include "daemon/cli/terminal/text_table.h"

namespace rayloc::cli {

// One string per line, without control characters; the daemon first, then targets,
// zones, access points, counters. Parts without content are left out. Where a table
// is wider than `width` characters, the least important columns are left out first.
std::vector<std::string> top_lines(const TopModel& model,
                                   TopModel::Clock::time_point now,
                                   std::size_t width = kAnyWidth);

}  // namespace rayloc::cli
