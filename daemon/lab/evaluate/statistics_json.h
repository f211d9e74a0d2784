// ErrorStatistics as JSON, with the keys of `rayloc evaluate --json`.
#pragma once

#include <nlohmann/json.hpp>

#include "daemon/lab/evaluate/error_statistics.h"

namespace rayloc {

// Infinite or absent values are null. Skills, which follow from the medians, have intervals only.
nlohmann::ordered_json to_json(const ErrorStatistics& statistics);

}  // namespace rayloc
