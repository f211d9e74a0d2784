// Charts: curves over two axes.
//
// Values that are not finite, or not positive on a
// logarithmic axis, are left out; the curve is broken there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/site/plan/drawing.h"

namespace rayloc::draw {

enum class AxisScale : std::uint8_t { kLinear, kLogarithmic };

struct ChartAxis {
  std::string label;
  AxisScale scale = AxisScale::kLinear;
  std::optional<double> lower;  // default: from the curves
  std::optional<double> upper;
};

struct ChartPoint {
  double x = 0.0;
  double y = 0.0;

  friend bool operator==(const ChartPoint&, const ChartPoint&) = default;
};

struct ChartCurve {
  std::string name;  // in the legend; empty: no entry
  std::vector<ChartPoint> points;
  Colour colour;
  bool dashed = false;
};

struct Chart {
  std::string title;
  ChartAxis x;
  ChartAxis y;
  std::vector<ChartCurve> curves;
};

// A chart without a displayable point shows a message.
Drawing draw_chart(const Chart& chart);

// Round numbers from `lower` to `upper`, about `count` of them; for
// a logarithmic axis powers of ten, or, with fewer than two of
// those, as for a linear one. REQUIRES: lower < upper, both finite.
std::vector<double> axis_ticks(double lower, double upper, AxisScale scale, std::size_t count);

// Logarithmic if all values are positive and span more than a decade.
AxisScale suitable_scale(std::span<const double> values);

// The share of `values` that is at most x, as a staircase; values that are not finite count as
// infinite, so that the curve ends below 1.
std::vector<ChartPoint> empirical_distribution(std::vector<double> values);

}  // namespace rayloc::draw
