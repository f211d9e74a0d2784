#include "daemon/site/survey/survey_answer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Numbers between commas; empty if one of them is invalid.
std::optional<std::vector<double>> numbers_of(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view cell = trimmed(text.substr(0, comma));
    double value = 0.0;
    const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (code != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
      return std::nullopt;
    }
    numbers.push_back(value);
    if (comma == std::string_view::npos) {
      return numbers;
    }
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

Expected<SurveyAnswer> parse_survey_answer(std::string_view line,
                                           std::span<const PlannedPoint> plan,
                                           const PlannedPoint* next,
                                           double usual_height) {
  const std::string_view text = trimmed(line);
  if (text == "q" || text == "Q") {
    return SurveyAnswer{true, {}};
  }
  if (text.empty()) {
    if (next == nullptr) {
      return bad_input(plan.empty() ? "type the position of the device: x,y,z"
                                    : "all planned points are done: type x,y,z, a name, or q");
    }
    return SurveyAnswer{false, *next};
  }
  const auto named = std::find_if(
      plan.begin(), plan.end(), [&](const PlannedPoint& point) { return point.name == text; });
  if (named != plan.end()) {
    return SurveyAnswer{false, *named};
  }
  const auto numbers = numbers_of(text);
  if (numbers && (numbers->size() == 2 || numbers->size() == 3)) {
    const double z = numbers->size() == 3 ? (*numbers)[2] : usual_height;
    return SurveyAnswer{false, {"", {(*numbers)[0], (*numbers)[1], z}}};
  }
  std::vector<std::string> names;
  for (const PlannedPoint& point : plan) {
    names.push_back(point.name);
  }
  return bad_input("'" + std::string(text) + "' is neither x,y,z (metres) nor x,y" +
                   (plan.empty() ? "" : " nor a planned point") +
                   (numbers || plan.empty() ? "" : suggestion(text, names)));
}

}  // namespace rayloc
