#include "daemon/lab/draw/chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/plan/palette.h"
#include "engine/base/check.h"

namespace rayloc::draw {
namespace {

constexpr double kChartWidth = 470.0;
constexpr double kChartHeight = 300.0;
constexpr double kLeft = 62.0;
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 46.0;
constexpr double kChartTextSize = 10.5;
constexpr double kChartLineHeight = 15.0;
constexpr Colour kGrid{225, 225, 225, 1.0};

bool can_be_shown(double value, AxisScale scale) {
  return std::isfinite(value) && (scale == AxisScale::kLinear || value > 0.0);
}

double on_scale(double value, AxisScale scale) {
  return scale == AxisScale::kLinear ? value : std::log10(value);
}

// Maps values to page coordinates.
class AxisMap {
 public:
  AxisMap(const ChartAxis& axis, const std::vector<double>& values, double from, double to)
      : scale_(axis.scale), from_(from), to_(to) {
    double lower = std::numeric_limits<double>::infinity();
    double upper = -lower;
    for (const double value : values) {
      if (can_be_shown(value, scale_)) {
        lower = std::min(lower, value);
        upper = std::max(upper, value);
      }
    }
    lower_ = axis.lower.value_or(lower);
    upper_ = axis.upper.value_or(upper);
    if (!(lower_ < upper_)) {  // single value: adds margins on either side
      const double middle = std::isfinite(lower_) ? lower_ : 1.0;
      const bool logarithmic = scale_ == AxisScale::kLogarithmic;
      lower_ = logarithmic ? 0.5 * middle : middle - 0.5;
      upper_ = logarithmic ? 2.0 * middle : middle + 0.5;
    }
  }

  double operator()(double value) const {
    const double lower = on_scale(lower_, scale_);
    const double share = (on_scale(value, scale_) - lower) / (on_scale(upper_, scale_) - lower);
    return from_ + share * (to_ - from_);
  }
  bool shows(double value) const {
    return can_be_shown(value, scale_) && value >= lower_ && value <= upper_;
  }
  std::vector<double> ticks(std::size_t count) const {
    return axis_ticks(lower_, upper_, scale_, count);
  }

 private:
  AxisScale scale_;
  double from_;
  double to_;
  double lower_ = 0.0;
  double upper_ = 1.0;
};

AxisMap make_map(const Chart& chart,
                 const ChartAxis& axis,
                 double ChartPoint::*value,
                 std::pair<double, double> page) {
  std::vector<double> values;
  for (const ChartCurve& curve : chart.curves) {
    for (const ChartPoint& point : curve.points) {
      if (can_be_shown(point.x, chart.x.scale) && can_be_shown(point.y, chart.y.scale)) {
        values.push_back(point.*value);
      }
    }
  }
  return {axis, values, page.first, page.second};
}

void draw_axes(const Chart& chart, const AxisMap& x, const AxisMap& y, Drawing& drawing) {
  constexpr std::size_t kTicks = 6;
  const double bottom = kChartHeight - kBottom;
  const double right = kChartWidth - kRight;
  for (const double tick : x.ticks(kTicks)) {
    drawing.shapes.emplace_back(Line{{{x(tick), kTop}, {x(tick), bottom}}, {kGrid, 0.8}});
    drawing.shapes.emplace_back(Text{{x(tick), bottom + kChartLineHeight},
                                     fmt::format("{:g}", tick),
                                     kChartTextSize,
                                     kFaintInk,
                                     TextAnchor::kMiddle});
  }
  for (const double tick : y.ticks(kTicks)) {
    drawing.shapes.emplace_back(Line{{{kLeft, y(tick)}, {right, y(tick)}}, {kGrid, 0.8}});
    drawing.shapes.emplace_back(Text{{kLeft - 6.0, y(tick) + 3.5},
                                     fmt::format("{:g}", tick),
                                     kChartTextSize,
                                     kFaintInk,
                                     TextAnchor::kEnd});
  }
  drawing.shapes.emplace_back(
      Line{{{kLeft, kTop}, {kLeft, bottom}, {right, bottom}}, {kFaintInk, 1.0}});
  drawing.shapes.emplace_back(Text{{0.5 * (kLeft + right), kChartHeight - 10.0},
                                   chart.x.label,
                                   kChartTextSize,
                                   kInk,
                                   TextAnchor::kMiddle});
  Text label{
      {13.0, 0.5 * (kTop + bottom)}, chart.y.label, kChartTextSize, kInk, TextAnchor::kMiddle};
  label.degrees = 90.0;
  drawing.shapes.emplace_back(std::move(label));
}

void draw_curve(const ChartCurve& curve, const AxisMap& x, const AxisMap& y, Drawing& drawing) {
  const Pen pen{curve.colour, 1.8, curve.dashed};
  std::vector<PagePoint> run;
  const auto finish = [&] {
    if (run.size() == 1) {  // a line of one point is invisible
      drawing.shapes.emplace_back(Circle{run.front(), 2.2, curve.colour, std::nullopt});
    } else if (!run.empty()) {
      drawing.shapes.emplace_back(Line{run, pen});
    }
    run.clear();
  };
  for (const ChartPoint& point : curve.points) {
    if (x.shows(point.x) && y.shows(point.y)) {
      run.push_back({x(point.x), y(point.y)});
    } else {
      finish();
    }
  }
  finish();
}

// Below the axes, one line per curve, so that nothing is covered.
void draw_curve_names(const Chart& chart, Drawing& drawing) {
  double y = kChartHeight + 6.0;
  for (const ChartCurve& curve : chart.curves) {
    if (curve.name.empty()) {
      continue;
    }
    drawing.shapes.emplace_back(
        Line{{{kLeft, y - 3.5}, {kLeft + 22.0, y - 3.5}}, {curve.colour, 1.8, curve.dashed}});
    drawing.shapes.emplace_back(Text{{kLeft + 30.0, y}, curve.name, kChartTextSize, kInk});
    y += kChartLineHeight;
  }
  drawing.height = y;
}

}  // namespace

std::vector<double> axis_ticks(double lower, double upper, AxisScale scale, std::size_t count) {
  RAYLOC_CHECK(lower < upper && std::isfinite(lower) && std::isfinite(upper) && count > 0);
  constexpr double kRounding = 1e-9;
  std::vector<double> ticks;
  if (scale == AxisScale::kLogarithmic) {
    const int first = static_cast<int>(std::ceil(std::log10(lower) - kRounding));
    const int last = static_cast<int>(std::floor(std::log10(upper) + kRounding));
    const int step = 1 + (last - first) / static_cast<int>(count);
    for (int power = first; power <= last; power += step) {
      ticks.push_back(std::pow(10.0, power));
    }
    if (ticks.size() > 1) {
      return ticks;
    }
    ticks.clear();
  }
  const double rough = (upper - lower) / static_cast<double>(count);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    step = rough <= factor * power ? factor * power : step;
  }
  const auto first = static_cast<std::int64_t>(std::ceil(lower / step - kRounding));
  const auto last = static_cast<std::int64_t>(std::floor(upper / step + kRounding));
  for (std::int64_t i = first; i <= last; ++i) {
    ticks.push_back(static_cast<double>(i) * step);
  }
  return ticks;
}

AxisScale suitable_scale(std::span<const double> values) {
  constexpr double kDecade = 10.0;
  double lower = std::numeric_limits<double>::infinity();
  double upper = 0.0;
  for (const double value : values) {
    if (std::isfinite(value)) {
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  }
  return lower > 0.0 && upper > kDecade * lower ? AxisScale::kLogarithmic : AxisScale::kLinear;
}

std::vector<ChartPoint> empirical_distribution(std::vector<double> values) {
  const auto count = static_cast<double>(values.size());
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::sort(values.begin(), values.end());
  std::vector<ChartPoint> stairs;
  double share = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    stairs.push_back({values[i], share});
    share = static_cast<double>(i + 1) / count;
    stairs.push_back({values[i], share});
  }
  return stairs;
}

Drawing draw_chart(const Chart& chart) {
  Drawing drawing;
  drawing.width = kChartWidth;
  Text title{{kLeft, 18.0}, chart.title, 12.0, kInk};
  title.bold = true;
  drawing.shapes.emplace_back(std::move(title));
  const AxisMap x = make_map(chart, chart.x, &ChartPoint::x, {kLeft, kChartWidth - kRight});
  const AxisMap y = make_map(chart, chart.y, &ChartPoint::y, {kChartHeight - kBottom, kTop});
  draw_axes(chart, x, y, drawing);
  const std::size_t before = drawing.shapes.size();
  for (const ChartCurve& curve : chart.curves) {
    draw_curve(curve, x, y, drawing);
  }
  if (drawing.shapes.size() == before) {
    drawing.shapes.emplace_back(Text{
        {0.5 * kChartWidth, 0.5 * kChartHeight}, "no data", 12.0, kFaintInk, TextAnchor::kMiddle});
  }
  draw_curve_names(chart, drawing);
  return drawing;
}

}  // namespace rayloc::draw
