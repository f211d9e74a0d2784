#include "daemon/lab/evaluate/evaluation_plots.h"

#include <algorithm>
#include <variant>

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace rayloc::evaluation_plots_test {
namespace {

bool has_text(const draw::Drawing& drawing, const std::string& text) {
  return std::any_of(drawing.shapes.begin(), drawing.shapes.end(), [&](const draw::Shape& shape) {
    const auto* words = std::get_if<draw::Text>(&shape);
    return words != nullptr && words->text.find(text) != std::string::npos;
  });
}

template <typename Kind>
std::size_t count(const draw::Drawing& drawing) {
  return static_cast<std::size_t>(
      std::count_if(drawing.shapes.begin(), drawing.shapes.end(), [](const draw::Shape& shape) {
        return std::holds_alternative<Kind>(shape);
      }));
}

LocationEstimate at(double x) {
  LocationEstimate estimate;
  estimate.position = Vec3d{x, 0, 1};
  estimate.covariance = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 1};
  estimate.hypotheses = {{*estimate.position, estimate.covariance, 0.8}};
  estimate.residual_probability = 0.2;
  return estimate;
}

TEST(EvaluationPlots, NameEveryDistribution) {
  const std::vector<NamedErrors> all = {{"estimates", {0.1, 0.2, PointResult::kMissed}},
                                        {"room centre", {1.0, 1.5, 2.0}}};
  const auto drawing = draw_error_distributions(all);
  EXPECT_TRUE(has_text(drawing, "estimates"));
  EXPECT_TRUE(has_text(drawing, "room centre"));
  EXPECT_FALSE(has_text(drawing, "no data"));
}

TEST(EvaluationPlots, TheMapShowsHitsAndMisses) {
  const RoomModel room = test::make_room();
  const std::vector<TruthPoint> truth = {{{}, {}, false, {0, 0, 1}}, {{}, {}, false, {0.5, 0, 1}}};
  const LocationEstimate hit = at(0.2);
  const std::vector<const LocationEstimate*> all_missed = {nullptr, nullptr};
  const std::vector<const LocationEstimate*> one_hit = {&hit, nullptr};
  const auto missed = draw_error_map(*room.scene, {{"a", {}}}, truth, all_missed);
  const auto located = draw_error_map(*room.scene, {{"a", {}}}, truth, one_hit);
  EXPECT_TRUE(has_text(missed, "missed"));
  EXPECT_EQ(count<draw::Line>(located), count<draw::Line>(missed) + 1);
}

TEST(EvaluationPlots, CoverageIsDrawnOnlyOfStatedUncertainty) {
  LocationEstimate unsure = at(0.1);
  unsure.is_uncertainty_stated = false;
  const LocationEstimate sure = at(0.1);
  const std::vector<PointResult> stated = {evaluate_point(TruthPoint(), &sure)};
  const std::vector<PointResult> silent = {evaluate_point(TruthPoint(), &unsure)};
  EXPECT_TRUE(has_text(draw_coverage(stated), "estimates (1)"));
  EXPECT_FALSE(has_text(draw_coverage(silent), "estimates"));
}

TEST(EvaluationPlots, ReliabilityCountsItsOutcomes) {
  const LocationEstimate one = at(0.0);
  const std::vector<TruthPoint> truth(1);
  const std::vector<const LocationEstimate*> matches = {&one};
  const auto drawing = draw_reliability(stated_outcomes(truth, matches));
  EXPECT_TRUE(has_text(drawing, "hypotheses, by weight (1)"));
  EXPECT_TRUE(has_text(drawing, "somewhere else (1)"));
}

}  // namespace
}  // namespace rayloc::evaluation_plots_test
