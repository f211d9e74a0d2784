#include "daemon/site/survey/points_csv.h"

#include "daemon/site/survey/csv_table.h"

namespace rayloc {

Expected<std::vector<SurveyPoint>> load_points_csv(const std::filesystem::path& path) {
  const auto table = CsvTable::load(path);
  RAYLOC_TRY(table);
  auto points = read_points(*table);
  if (points && points->empty()) {
    return bad_input(path.string() + ": no spots, only a header");
  }
  // A person walks the survey, and its rows are compared with each other.
  constexpr std::size_t kMaxPoints = 20'000;
  if (points && points->size() > kMaxPoints) {
    return bad_input(path.string() + ": " + std::to_string(points->size()) + " spots; at most " +
                     std::to_string(kMaxPoints) + " are read: is this the survey?");
  }
  return points;
}

Expected<std::vector<SurveyPoint>> read_points(const CsvTable& table) {
  const auto columns = table.require({"t_start", "t_end", "x", "y", "z"});
  RAYLOC_TRY(columns);
  std::vector<SurveyPoint> points;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto start = table.time(row, (*columns)[0]);
    const auto end = table.time(row, (*columns)[1]);
    const auto x = table.number(row, (*columns)[2]);
    const auto y = table.number(row, (*columns)[3]);
    const auto z = table.number(row, (*columns)[4]);
    for (const auto* time : {&start, &end}) {
      if (!*time) {
        return tl::make_unexpected(time->error());
      }
    }
    for (const auto* number : {&x, &y, &z}) {
      if (!*number) {
        return tl::make_unexpected(number->error());
      }
    }
    if (*end < *start) {
      return tl::make_unexpected(
          table.error_at(row, (*columns)[1], "t_end is before t_start; exchange them"));
    }
    points.push_back({*start, *end, {*x, *y, *z}, table.line(row)});
  }
  return points;
}

bool has_instants(const CsvTable& table) {
  return table.has_column("t") && !table.has_column("t_start");
}

Expected<std::vector<SurveyPoint>> read_instants(const CsvTable& table) {
  const auto columns = table.require({"t", "x", "y", "z"});
  RAYLOC_TRY(columns);
  std::vector<SurveyPoint> points;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto time = table.time(row, (*columns)[0]);
    RAYLOC_TRY(time);
    SurveyPoint point{*time, *time, {}, table.line(row)};
    std::size_t column = 1;
    for (double* coordinate : {&point.position.x, &point.position.y, &point.position.z}) {
      const auto value = table.number(row, (*columns)[column++]);
      RAYLOC_TRY(value);
      *coordinate = *value;
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace rayloc
