#include "daemon/lab/draw/chart.h"

#include <algorithm>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::draw::chart_test {
namespace {

constexpr Colour kBlue{0, 0, 255, 1.0};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Chart chart_of(std::vector<ChartPoint> points, AxisScale y_scale = AxisScale::kLinear) {
  return {"title",
          {"x", AxisScale::kLinear, {}, {}},
          {"y", y_scale, {}, {}},
          {{"curve", std::move(points), kBlue, false}}};
}

// The runs of the curve; the last blue line is its sample in the legend.
std::vector<Line> runs(const Drawing& drawing) {
  std::vector<Line> found;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* line = std::get_if<Line>(&shape);
        line != nullptr && line->pen.colour == kBlue) {
      found.push_back(*line);
    }
  }
  found.pop_back();
  return found;
}

bool has_text(const Drawing& drawing, const std::string& words) {
  return std::any_of(drawing.shapes.begin(), drawing.shapes.end(), [&](const Shape& shape) {
    const auto* text = std::get_if<Text>(&shape);
    return text != nullptr && text->text == words;
  });
}

TEST(AxisTicks, AreRoundNumbers) {
  EXPECT_EQ(axis_ticks(0.0, 10.0, AxisScale::kLinear, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(axis_ticks(-3.0, 4.0, AxisScale::kLinear, 4), (std::vector<double>{-2, 0, 2, 4}));
}

TEST(AxisTicks, ArePowersOfTenOnALogarithmicAxis) {
  EXPECT_EQ(axis_ticks(0.5, 2000.0, AxisScale::kLogarithmic, 6),
            (std::vector<double>{1, 10, 100, 1000}));
  EXPECT_EQ(axis_ticks(1e-12, 1.0, AxisScale::kLogarithmic, 6).size(), 5U);
}

TEST(AxisTicks, AreLinearWithinADecade) {
  EXPECT_EQ(axis_ticks(2.0, 8.0, AxisScale::kLogarithmic, 4), (std::vector<double>{2, 4, 6, 8}));
}

TEST(SuitableScale, IsLogarithmicBeyondADecadeOfPositiveValues) {
  EXPECT_EQ(suitable_scale(std::vector<double>{1.0, 11.0}), AxisScale::kLogarithmic);
  EXPECT_EQ(suitable_scale(std::vector<double>{2.0, 11.0}), AxisScale::kLinear);
  EXPECT_EQ(suitable_scale(std::vector<double>{-1.0, 110.0}), AxisScale::kLinear);
  EXPECT_EQ(suitable_scale({}), AxisScale::kLinear);
}

TEST(EmpiricalDistribution, IsAStaircaseToOne) {
  EXPECT_EQ(empirical_distribution({3.0, 1.0}),
            (std::vector<ChartPoint>{{1.0, 0.0}, {1.0, 0.5}, {3.0, 0.5}, {3.0, 1.0}}));
}

TEST(EmpiricalDistribution, EndsBelowOneWithInfiniteValues) {
  EXPECT_EQ(empirical_distribution({kInfinity, 1.0}).back(), (ChartPoint{1.0, 0.5}));
}

TEST(Chart, PutsLargerValuesFurtherRightAndHigher) {
  const auto lines = runs(draw_chart(chart_of({{0.0, 1.0}, {1.0, 5.0}})));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LT(lines[0].points[0].x, lines[0].points[1].x);
  EXPECT_GT(lines[0].points[0].y, lines[0].points[1].y);
}

TEST(Chart, SpacesDecadesEvenlyOnALogarithmicAxis) {
  const auto lines =
      runs(draw_chart(chart_of({{0, 1}, {1, 10}, {2, 100}}, AxisScale::kLogarithmic)));
  ASSERT_EQ(lines.size(), 1U);
  const auto& p = lines[0].points;
  EXPECT_NEAR(p[0].y - p[1].y, p[1].y - p[2].y, 1e-9);
}

TEST(Chart, BreaksACurveWhereNothingCanBeShown) {
  const auto lines = runs(draw_chart(chart_of({{0, 1}, {1, 2}, {2, kInfinity}, {3, 2}, {4, 1}})));
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].points.size(), 2U);
}

TEST(Chart, KeepsToTheLimitsOfAnAxis) {
  Chart chart = chart_of({{0.0, 0.2}, {1.0, 0.8}, {2.0, 7.0}});
  chart.y.lower = 0.0;
  chart.y.upper = 1.0;
  const auto lines = runs(draw_chart(chart));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].points.size(), 2U);
}

TEST(Chart, ShowsThatItHasNoData) {
  EXPECT_TRUE(has_text(draw_chart(chart_of({})), "no data"));
  EXPECT_FALSE(has_text(draw_chart(chart_of({{0, 1}, {1, 2}})), "no data"));
}

TEST(Chart, ShowsASinglePointAsADot) {
  const Drawing drawing = draw_chart(chart_of({{3.0, 4.0}}));
  EXPECT_TRUE(runs(drawing).empty());
  EXPECT_EQ(std::count_if(drawing.shapes.begin(),
                          drawing.shapes.end(),
                          [](const Shape& s) { return std::holds_alternative<Circle>(s); }),
            1);
}

TEST(Chart, NamesItsAxesAndCurves) {
  const Drawing drawing = draw_chart(chart_of({{0, 1}, {1, 2}}));
  for (const char* words : {"title", "x", "y", "curve"}) {
    EXPECT_TRUE(has_text(drawing, words)) << words;
  }
}

}  // namespace
}  // namespace rayloc::draw::chart_test
