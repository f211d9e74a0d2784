#include "daemon/site/survey/time_offset.h"

#include <chrono>

#include "daemon/site/survey/csv_table.h"

namespace rayloc {

Expected<Duration> parse_time_offset(const std::string& text) {
  const auto offset = parse_decimal_seconds(text);
  constexpr auto kMaxOffset = std::chrono::hours(24 * 365 * 100);
  if (!offset || *offset > kMaxOffset || *offset < -kMaxOffset) {
    return make_error(
        ErrorKind::kUsage,
        "--time-offset " + text + ": write seconds as a decimal number, at most a century");
  }
  return *offset;
}

Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path,
                                                   Duration offset) {
  auto points = load_points_csv(path);
  if (points) {
    for (SurveyPoint& point : *points) {
      point.t_start += offset;
      point.t_end += offset;
    }
  }
  return points;
}

Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path,
                                                   const std::string& offset) {
  const auto parsed = parse_time_offset(offset);
  return parsed ? load_points_csv(path, *parsed) : tl::make_unexpected(parsed.error());
}

}  // namespace rayloc
