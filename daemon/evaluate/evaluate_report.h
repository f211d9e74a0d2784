// The two forms in which `rayloc evaluate` prints its figures.
#pragma once

#include <string>

#include "daemon/evaluate/error_statistics.h"

namespace rayloc::cli {

// One line with the keys of INTERFACE 3.2; what is infinite or absent is null.
std::string statistics_json(const ErrorStatistics& statistics);

// For people, with 95 % intervals; what is infinite is "inf".
std::string statistics_table(const ErrorStatistics& statistics);

}  // namespace rayloc::cli
