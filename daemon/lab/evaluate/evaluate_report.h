// The two output forms of `rayloc evaluate`.
#pragma once

#include <string>

#include "daemon/lab/evaluate/error_statistics.h"

namespace rayloc {

// One line with the keys of INTERFACE 3.2; infinite or absent values are null.
std::string statistics_json(const ErrorStatistics& statistics);

// For people, with 95 % intervals; infinite values are "missed".
std::string statistics_table(const ErrorStatistics& statistics);

}  // namespace rayloc
