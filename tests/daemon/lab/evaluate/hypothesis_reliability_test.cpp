#include "daemon/lab/evaluate/hypothesis_reliability.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rayloc::hypothesis_reliability_test {
namespace {

constexpr double kSigma = 0.1;  // [m]

LocationEstimate estimate_of(const std::vector<std::pair<double, double>>& place_and_weight,
                             double left_over) {
  LocationEstimate estimate;
  estimate.position = Vec3d{};
  estimate.residual_probability = left_over;
  for (const auto& [x, weight] : place_and_weight) {
    estimate.hypotheses.push_back(
        {{x, 0, 0}, {kSigma * kSigma, 0, 0, 0, kSigma * kSigma, 0, 0, 0, 1}, weight});
  }
  return estimate;
}

StatedOutcomes outcomes_of(const LocationEstimate& estimate, const Vec3d& truth) {
  const std::vector<TruthPoint> points = {{{}, {}, false, truth}};
  const std::vector<const LocationEstimate*> matches = {&estimate};
  return stated_outcomes(points, matches);
}

TEST(HypothesisReliability, ExactlyOneOutcomeHappens) {
  const LocationEstimate estimate = estimate_of({{0.0, 0.6}, {1.0, 0.3}}, 0.1);
  const auto at_second = outcomes_of(estimate, {1.05, 0, 0});
  ASSERT_EQ(at_second.hypotheses.size(), 2U);
  EXPECT_FALSE(at_second.hypotheses[0].happened);
  EXPECT_TRUE(at_second.hypotheses[1].happened);
  EXPECT_DOUBLE_EQ(at_second.hypotheses[1].stated, 0.3);
  EXPECT_FALSE(at_second.left_over[0].happened);
  const auto outside = outcomes_of(estimate, {0.5, 0, 0});
  EXPECT_FALSE(outside.hypotheses[0].happened);
  EXPECT_FALSE(outside.hypotheses[1].happened);
  EXPECT_TRUE(outside.left_over[0].happened);
  EXPECT_DOUBLE_EQ(outside.left_over[0].stated, 0.1);
}

TEST(HypothesisReliability, BelongsToOneOnlyWithinItsRegionOf99Percent) {
  const double edge = kSigma * std::sqrt(-2.0 * std::log(0.01));
  const LocationEstimate estimate = estimate_of({{0.0, 1.0}}, 0.0);
  EXPECT_TRUE(outcomes_of(estimate, {0.999 * edge, 0, 0}).hypotheses[0].happened);
  EXPECT_FALSE(outcomes_of(estimate, {1.001 * edge, 0, 0}).hypotheses[0].happened);
}

TEST(HypothesisReliability, TheDenserOfTwoOverlappingHypothesesIsRight) {
  const LocationEstimate estimate = estimate_of({{0.0, 0.5}, {0.1, 0.4}}, 0.1);
  EXPECT_TRUE(outcomes_of(estimate, {0.09, 0, 0}).hypotheses[1].happened);
  EXPECT_TRUE(outcomes_of(estimate, {0.04, 0, 0}).hypotheses[0].happened);
}

TEST(HypothesisReliability, OmitsEstimatesWithoutHypotheses) {
  LocationEstimate none;
  const LocationEstimate without = estimate_of({}, 1.0);
  EXPECT_TRUE(outcomes_of(none, {}).left_over.empty());
  EXPECT_TRUE(outcomes_of(without, {}).left_over.empty());
}

TEST(HypothesisReliability, BinsByStatedProbability) {
  std::vector<StatedOutcome> outcomes;
  outcomes.reserve(11);
  for (int i = 0; i < 10; ++i) {
    outcomes.push_back({0.25, i < 2});
  }
  outcomes.push_back({1.0, true});
  const auto bins = reliability(outcomes, 10);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_NEAR(bins[0].stated, 0.25, 1e-12);
  EXPECT_NEAR(bins[0].happened, 0.2, 1e-12);
  EXPECT_EQ(bins[0].count, 10U);
  // Wilson: (0.2 + z^2 / 20 -+ z sqrt(0.016 + z^2 / 400)) / (1 + z^2 / 10), z = 1.96.
  EXPECT_NEAR(bins[0].lower, 0.0566822, 1e-6);
  EXPECT_NEAR(bins[0].upper, 0.5098375, 1e-6);
  EXPECT_EQ(bins[1].count, 1U);
  EXPECT_DOUBLE_EQ(bins[1].happened, 1.0);
}

}  // namespace
}  // namespace rayloc::hypothesis_reliability_test
