// --time-offset: seconds to be added to the times of surveyed points if the clock of the survey and
// that of the recordings differ.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc {

inline constexpr const char* kTimeOffsetHelp =
    "seconds added to the times of the points, where they were noted by another clock than that of "
    "the recordings: -7200 for a time zone two hours ahead";

// A decimal number of seconds of at most a century; otherwise an Error of usage.
Expected<Duration> parse_time_offset(const std::string& text);

// load_points_csv() with the offset added to all times.
Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path,
                                                   Duration offset);
Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path,
                                                   const std::string& offset);

}  // namespace rayloc
