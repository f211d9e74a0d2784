#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/draw/chart.h"
#include "daemon/lab/evaluate/evaluation_plots.h"
#include "daemon/lab/experiment/experiment_report.h"
#include "daemon/site/plan/palette.h"

namespace rayloc {
namespace {

using draw::Chart;
using draw::ChartCurve;

constexpr std::size_t kMaxWithIntervals = 4;  // curves: more intervals overlap
constexpr std::size_t kMaxDistributions = 8;  // curves per chart

// "method paper, alpha 0.5": the values of all axes except `without`.
std::string label_of(const Study& study, const Condition& condition, const std::string& without) {
  std::string label;
  for (const std::string& axis : study.axes) {
    if (axis != without) {
      label += (label.empty() ? "" : ", ") + axis + " " + condition_text(condition, axis);
    }
  }
  return label.empty() ? study.name : label;
}

using StatisticsValue = double ErrorStatistics::*;

draw::Drawing draw_over(const StudyResult& result,
                        const char* title,
                        const char* name,
                        StatisticsValue value) {
  const Study& study = *result.study;
  std::vector<std::string> labels;  // in the order of the study
  std::map<std::string, std::vector<const ConditionResult*>> curves;
  for (const ConditionResult& condition : result.conditions) {
    const std::string label = label_of(study, condition.condition, study.over);
    if (!curves.contains(label)) {
      labels.push_back(label);
    }
    curves[label].push_back(&condition);
  }
  Chart chart;
  chart.title = title;
  chart.x.label = study.over;
  chart.y.label = title;
  chart.y.lower = 0.0;
  std::vector<double> xs;
  for (const std::string& label : labels) {
    ChartCurve curve{label, {}, draw::curve_colour(chart.curves.size()), false};
    for (const ConditionResult* condition : curves[label]) {
      const double x = *condition_number(condition->condition, study.over);
      xs.push_back(x);
      curve.points.push_back({x, condition->statistics.*value});
    }
    chart.curves.push_back(std::move(curve));
  }
  if (labels.size() <= kMaxWithIntervals) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      for (const ConditionResult* condition : curves[labels[i]]) {
        const auto interval = condition->statistics.ci95.find(name);
        if (interval != condition->statistics.ci95.end()) {
          const double x = *condition_number(condition->condition, study.over);
          chart.curves.push_back({"",
                                  {{x, interval->second[0]}, {x, interval->second[1]}},
                                  draw::curve_colour(i),
                                  true});
        }
      }
    }
  }
  chart.x.scale = draw::suitable_scale(xs);
  return draw::draw_chart(chart);
}

}  // namespace

std::vector<draw::Drawing> draw_study(const StudyResult& result) {
  std::vector<draw::Drawing> drawings;
  if (!result.study->over.empty()) {
    drawings.push_back(
        draw_over(result, "median error [m]", "median_m", &ErrorStatistics::median_m));
    drawings.push_back(
        draw_over(result, "share below 0.5 m", "below_0_5", &ErrorStatistics::below_0_5));
  }
  if (result.conditions.size() <= kMaxDistributions) {
    std::vector<NamedErrors> distributions;
    for (const ConditionResult& condition : result.conditions) {
      NamedErrors& one = distributions.emplace_back();
      one.name = label_of(*result.study, condition.condition, "");
      for (const PointResult& point : condition.points) {
        one.errors.push_back(point.error);
      }
    }
    drawings.push_back(draw_error_distributions(distributions));
  }
  return drawings;
}

}  // namespace rayloc
