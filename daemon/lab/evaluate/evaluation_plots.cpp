#include "daemon/lab/evaluate/evaluation_plots.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/draw/chart.h"
#include "daemon/site/plan/palette.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

using draw::Chart;
using draw::ChartCurve;
using draw::Drawing;

ChartCurve diagonal(const char* name) {
  return {name, {{0.0, 0.0}, {1.0, 1.0}}, draw::kFaintInk, true};
}

Chart probabilities(std::string title, std::string x, std::string y) {
  Chart chart;
  chart.title = std::move(title);
  chart.x = {std::move(x), draw::AxisScale::kLinear, 0.0, 1.0};
  chart.y = {std::move(y), draw::AxisScale::kLinear, 0.0, 1.0};
  return chart;
}

// A curve through the bins, and an error bar for the interval of each.
void add_bins(const std::string& name,
              const std::vector<StatedOutcome>& outcomes,
              const draw::Colour& colour,
              Chart& chart) {
  constexpr std::size_t kBins = 10;
  ChartCurve curve{fmt::format("{} ({})", name, outcomes.size()), {}, colour, false};
  for (const ReliabilityBin& bin : reliability(outcomes, kBins)) {
    curve.points.push_back({bin.stated, bin.happened});
    chart.curves.push_back({"", {{bin.stated, bin.lower}, {bin.stated, bin.upper}}, colour, true});
  }
  chart.curves.push_back(std::move(curve));
}

}  // namespace

Drawing draw_error_distributions(std::span<const NamedErrors> all) {
  Chart chart;
  chart.title = "Distribution of horizontal errors";
  chart.x.label = "error [m]";
  chart.y = {"share of points", draw::AxisScale::kLinear, 0.0, 1.0};
  std::vector<double> values;
  for (const NamedErrors& one : all) {
    chart.curves.push_back({one.name,
                            draw::empirical_distribution(one.errors),
                            draw::curve_colour(chart.curves.size()),
                            false});
    values.insert(values.end(), one.errors.begin(), one.errors.end());
  }
  chart.x.scale = draw::suitable_scale(values);
  return draw::draw_chart(chart);
}

Drawing draw_error_map(const Scene& scene,
                       std::vector<draw::MapAntenna> antennas,
                       std::span<const TruthPoint> truth,
                       std::span<const LocationEstimate* const> matches) {
  RAYLOC_CHECK(truth.size() == matches.size());
  draw::RoomMap map;
  map.scene = &scene;
  map.title = "Errors: a line from the truth (dot) to the estimate";
  map.antennas = std::move(antennas);
  map.line_width = 1.2;
  map.value_name = "error [m]";
  map.colour = draw::power_colour;
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3d& at = truth[i].position;
    if (matches[i] == nullptr || !matches[i]->position) {
      map.dots.push_back({at, PointResult::kMissed, true});
      map.ring_meaning = "missed";
      continue;
    }
    const double error = horizontal_distance(*matches[i]->position, at);
    largest = std::max(largest, error);
    map.dots.push_back({at, error, false});
    map.lines.push_back({at, *matches[i]->position, error});
  }
  constexpr double kMinScale = 0.01;  // [m]
  map.highest = std::max(largest, kMinScale);
  return draw_room_map(map);
}

Drawing draw_coverage(std::span<const PointResult> results) {
  Chart chart = probabilities("Do the stated regions hold the truth?",
                              "stated probability of the region",
                              "share of points inside");
  chart.curves.push_back(diagonal("right: as often as stated"));
  std::vector<double> regions;
  for (const PointResult& result : results) {
    regions.push_back(result.region);
  }
  const bool is_stated = std::any_of(
      results.begin(), results.end(), [](const PointResult& r) { return r.is_uncertainty_stated; });
  if (is_stated) {
    chart.curves.push_back({fmt::format("estimates ({})", results.size()),
                            draw::empirical_distribution(std::move(regions)),
                            draw::curve_colour(0),
                            false});
  }
  return draw::draw_chart(chart);
}

Drawing draw_reliability(const StatedOutcomes& outcomes) {
  Chart chart =
      probabilities("Are weights probabilities? (bars: 95 %)", "stated probability", "came true");
  chart.curves.push_back(diagonal("right: as often as stated"));
  add_bins("hypotheses, by weight", outcomes.hypotheses, draw::curve_colour(0), chart);
  add_bins("somewhere else", outcomes.left_over, draw::curve_colour(1), chart);
  return draw::draw_chart(chart);
}

}  // namespace rayloc
