#include "daemon/lab/experiment/experiment_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/draw/html.h"
#include "daemon/lab/draw/svg.h"
#include "daemon/lab/evaluate/statistics_json.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

// Keys of all conditions, so that all rows of a report have the same columns.
std::vector<std::string> keys_of(const std::vector<StudyResult>& results) {
  std::vector<const Condition*> conditions;
  for (const StudyResult& result : results) {
    for (const ConditionResult& condition : result.conditions) {
      conditions.push_back(&condition.condition);
    }
  }
  return reported_keys(conditions);
}

// Figures in the tables, by their names in the JSON.
constexpr std::array<std::string_view, 12> kFigures = {"median_m",
                                                       "mean_m",
                                                       "rmse_m",
                                                       "cep90_m",
                                                       "cep95_m",
                                                       "below_0_5",
                                                       "below_1",
                                                       "coverage_50",
                                                       "coverage_95",
                                                       "anees",
                                                       "best_of_5_median_m",
                                                       "room_centre_median_m"};

std::string csv_number(const Json& value) {
  return value.is_null() ? "" : fmt::format("{:.6g}", value.get<double>());
}

// Quotes a cell that contains a comma.
std::string csv_cell(std::string text) {
  for (char& c : text) {
    c = c == ',' ? ';' : c;
  }
  return text;
}

std::string html_number(const Json& figures, const char* name) {
  const Json& value = figures.at(name);
  if (value.is_null()) {
    return "\u2013";
  }
  std::string text = fmt::format("{:.3f}", value.get<double>());
  const Json& intervals = figures.at("ci95");
  if (intervals.contains(name) && !intervals.at(name)[0].is_null() &&
      !intervals.at(name)[1].is_null()) {
    text += fmt::format(" [{:.3f}, {:.3f}]",
                        intervals.at(name)[0].get<double>(),
                        intervals.at(name)[1].get<double>());
  }
  return text;
}

std::string study_table(const StudyResult& result) {
  draw::HtmlTable table;
  table.columns = result.study->axes;
  table.columns.insert(table.columns.end(),
                       {"points",
                        "missed",
                        "median [m]",
                        "90 % [m]",
                        "below 0.5 m",
                        "in 50 % region",
                        "in 95 % region",
                        "best of 5 [m]",
                        "room centre, median [m]",
                        "refused"});
  for (const ConditionResult& condition : result.conditions) {
    const Json figures = to_json(condition.statistics);
    std::vector<std::string>& row = table.rows.emplace_back();
    for (const std::string& axis : result.study->axes) {
      row.push_back(condition_text(condition.condition, axis));
    }
    row.push_back(std::to_string(condition.statistics.n));
    row.push_back(std::to_string(condition.statistics.missed));
    for (const char* name : {"median_m",
                             "cep90_m",
                             "below_0_5",
                             "coverage_50",
                             "coverage_95",
                             "best_of_5_median_m",
                             "room_centre_median_m"}) {
      row.push_back(html_number(figures, name));
    }
    row.push_back(condition.refusal);
  }
  return to_html(table);
}

// Values that all conditions of the study share and that differ from the defaults.
std::string held_text(const Study& study) {
  const Condition usual = default_condition();
  const Condition& first = study.conditions.front();
  std::string text;
  const std::array<const Condition*, 1> held = {&first};
  for (const std::string& key : reported_keys(held)) {
    const bool is_axis = std::find(study.axes.begin(), study.axes.end(), key) != study.axes.end();
    const std::string value = condition_text(first, key);
    if (!is_axis && value != condition_text(usual, key)) {
      text.append(text.empty() ? "" : ", ").append(key).append(" = ").append(value);
    }
  }
  return text;
}

std::string study_html(const StudyResult& result) {
  const Study& study = *result.study;
  std::string html = "<h2>" + draw::html_text(study.name) + "</h2>\n";
  if (!study.claim.empty()) {
    html += draw::html_paragraph("Claimed: " + study.claim);
  }
  if (const std::string held = held_text(study); !held.empty()) {
    html += "<p class=\"faint\">Held: " + draw::html_text(held) + "</p>\n";
  }
  html += "<div class=\"figures\">\n";
  for (const draw::Drawing& drawing : draw_study(result)) {
    html += draw::to_svg_element(drawing);
  }
  return html + "</div>\n" + study_table(result);
}

}  // namespace

std::string experiment_json(const Experiment& experiment, const std::vector<StudyResult>& results) {
  Json json;
  json["name"] = experiment.name;
  json["seed"] = experiment.seed;
  Json& studies = json["studies"] = Json::array();
  const std::vector<std::string> keys = keys_of(results);
  for (const StudyResult& result : results) {
    Json study;
    study["name"] = result.study->name;
    study["claim"] = result.study->claim;
    study["axes"] = result.study->axes;
    study["over"] = result.study->over;
    Json& conditions = study["conditions"] = Json::array();
    for (const ConditionResult& condition : result.conditions) {
      Json values = Json::object();
      for (const std::string& key : keys) {
        values[key] = condition_text(condition.condition, key);
      }
      conditions.push_back(
          {{"values", std::move(values)}, {"statistics", to_json(condition.statistics)}});
      if (!condition.refusal.empty()) {
        conditions.back()["refused"] = condition.refusal;
      }
    }
    studies.push_back(std::move(study));
  }
  return json.dump(1) + "\n";
}

std::string experiment_csv(const std::vector<StudyResult>& results) {
  const std::vector<std::string> keys = keys_of(results);
  std::string csv = "study";
  for (const std::string& key : keys) {
    csv += "," + key;
  }
  const bool some_refuse = std::any_of(results.begin(), results.end(), [](const auto& result) {
    return std::any_of(result.conditions.begin(), result.conditions.end(), [](const auto& one) {
      return !one.refusal.empty();
    });
  });
  csv += ",n,missed";
  for (const std::string_view figure : kFigures) {
    csv += fmt::format(",{0},{0}_lower,{0}_upper", figure);
  }
  csv += some_refuse ? ",refused\n" : "\n";
  for (const StudyResult& result : results) {
    for (const ConditionResult& condition : result.conditions) {
      csv += csv_cell(result.study->name);
      for (const std::string& key : keys) {
        csv += "," + csv_cell(condition_text(condition.condition, key));
      }
      csv += fmt::format(",{},{}", condition.statistics.n, condition.statistics.missed);
      const Json figures = to_json(condition.statistics);
      for (const std::string_view figure : kFigures) {
        const std::string name(figure);
        const Json& intervals = figures.at("ci95");
        const Json interval =
            intervals.contains(name) ? intervals.at(name) : Json::array({nullptr, nullptr});
        csv += "," + csv_number(figures.at(name)) + "," + csv_number(interval[0]) + "," +
               csv_number(interval[1]);
      }
      csv += (some_refuse ? "," + csv_cell(condition.refusal) : "") + "\n";
    }
  }
  return csv;
}

std::string experiment_html(const Experiment& experiment, const std::vector<StudyResult>& results) {
  std::string body = fmt::format(
      "<p>Simulated captures of the project's own tracer, seed {}. The model that locates made the "
      "recordings: the figures compare methods and conditions with each other, and do not state "
      "the accuracy in a real room. Brackets and bars: bootstrap intervals of 95 % over spots. "
      "Errors are horizontal; a miss counts as infinitely far.</p>\n",
      experiment.seed);
  for (const StudyResult& result : results) {
    body += study_html(result);
  }
  return draw::html_page(experiment.name, body);
}

std::string experiment_errors_csv(const std::vector<StudyResult>& results) {
  std::string csv = "study,condition,point,error_m\n";
  for (std::size_t s = 0; s < results.size(); ++s) {
    for (std::size_t c = 0; c < results[s].conditions.size(); ++c) {
      const std::vector<PointResult>& points = results[s].conditions[c].points;
      for (std::size_t p = 0; p < points.size(); ++p) {
        csv += fmt::format("{},{},{},", s + 1, c + 1, p + 1);
        csv += std::isfinite(points[p].error) ? fmt::format("{}\n", points[p].error) : "\n";
      }
    }
  }
  return csv;
}

Expected<void> write_experiment_report(const std::filesystem::path& directory,
                                       const Experiment& experiment,
                                       const std::vector<StudyResult>& results) {
  for (const auto& [name, content] :
       {std::pair{"report.json", experiment_json(experiment, results)},
        std::pair{"report.csv", experiment_csv(results)},
        std::pair{"errors.csv", experiment_errors_csv(results)},
        std::pair{"report.html", experiment_html(experiment, results)}}) {
    RAYLOC_TRY(write_file(directory / name, content));
  }
  return {};
}

}  // namespace rayloc
