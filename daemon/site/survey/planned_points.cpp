#include "daemon/site/survey/planned_points.h"

#include <array>
#include <cstddef>
#include <cstdio>
#include <set>

#include "daemon/site/survey/csv_table.h"
#include "engine/base/printable.h"

namespace rayloc {

Expected<std::vector<PlannedPoint>> load_planned_points(const std::filesystem::path& file) {
  const auto table = CsvTable::load(file);
  RAYLOC_TRY(table);
  const auto columns = table->require({"x", "y", "z"});
  RAYLOC_TRY(columns);
  const auto names = table->require({"name"});
  std::vector<PlannedPoint> points;
  std::set<std::string> taken;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    PlannedPoint point;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto number = table->number(row, (*columns)[axis]);
      RAYLOC_TRY(number);
      (axis == 0 ? point.position.x : axis == 1 ? point.position.y : point.position.z) = *number;
    }
    point.name = names ? printable(std::string(table->text(row, names->front())))
                       : "p" + std::to_string(row + 1);
    if (!taken.insert(point.name).second) {
      return tl::make_unexpected(table->error_at(
          row, names->front(), "'" + point.name + "' is the name of another point; give each one"));
    }
    points.push_back(std::move(point));
  }
  if (points.empty()) {
    return bad_input(file.string() + ": no points, only a header");
  }
  return points;
}

std::string to_csv(std::span<const PlannedPoint> points) {
  std::string text = "x,y,z,name\n";
  for (const PlannedPoint& point : points) {
    std::array<char, 96> numbers{};
    std::snprintf(numbers.data(),
                  numbers.size(),
                  "%.3f,%.3f,%.3f,",
                  point.position.x,
                  point.position.y,
                  point.position.z);
    text += numbers.data() + point.name + "\n";
  }
  return text;
}

}  // namespace rayloc
