#include "daemon/lab/evaluate/error_statistics.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace rayloc::error_statistics_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<PointResult> results_of(const std::vector<LocationEstimate>& estimates) {
  std::vector<PointResult> results;
  results.reserve(estimates.size());
  for (const LocationEstimate& estimate : estimates) {
    results.push_back(evaluate_point(TruthPoint(), &estimate));
  }
  return results;
}

// A truth at the origin for each estimate.
ErrorStatistics statistics_of(const std::vector<LocationEstimate>& estimates,
                              const Controls& controls = {}) {
  return compute_statistics(results_of(estimates), controls, {200, 1, 1});
}

// Off by (3, 4) / 5 * error horizontally, and by 9 m in height, which does not count.
LocationEstimate off_by(double error) {
  LocationEstimate estimate;
  estimate.position = Vec3d{0.6 * error, 0.8 * error, 9.0};
  estimate.covariance = {0.25, 0, 0, 0, 0.25, 0, 0, 0, 1e-4};
  return estimate;
}
LocationEstimate no_fix() { return {}; }
// As the paper's method answers.
LocationEstimate unsure(double error) {
  LocationEstimate estimate = off_by(error);
  estimate.is_uncertainty_stated = false;
  estimate.covariance = {};
  return estimate;
}

TEST(Percentile, InterpolatesBetweenOrderStatistics) {
  // numpy.percentile([15, 20, 35, 40, 50], [0, 5, 50, 40, 90, 100])
  const std::vector<double> values{50, 15, 40, 20, 35};
  EXPECT_DOUBLE_EQ(percentile(values, 0.0), 15);
  EXPECT_DOUBLE_EQ(percentile(values, 0.05), 16);
  EXPECT_DOUBLE_EQ(percentile(values, 0.5), 35);
  EXPECT_DOUBLE_EQ(percentile(values, 0.4), 29);
  EXPECT_DOUBLE_EQ(percentile(values, 0.9), 46);
  EXPECT_DOUBLE_EQ(percentile(values, 1.0), 50);
  EXPECT_DOUBLE_EQ(percentile({7}, 0.5), 7);
}

TEST(Percentile, IsInfiniteOnlyWhenAnInfiniteValueTakesPart) {
  EXPECT_EQ(percentile({1, 2, kInfinity}, 0.5), 2);
  EXPECT_EQ(percentile({1, 2, kInfinity, kInfinity}, 0.5), kInfinity);
  EXPECT_EQ(percentile({1, kInfinity, kInfinity}, 0.5), kInfinity);
  std::vector<double> values(21, 1.0);
  values[20] = kInfinity;
  EXPECT_EQ(percentile(values, 0.95), 1.0);
}

TEST(ErrorStatistics, MatchAHandComputedCase) {
  const ErrorStatistics s =
      statistics_of({off_by(0.1), off_by(0.3), off_by(0.5), off_by(0.9), off_by(2.2)});
  EXPECT_EQ(s.n, 5U);
  EXPECT_EQ(s.missed, 0U);
  EXPECT_NEAR(s.median_m, 0.5, 1e-12);
  EXPECT_NEAR(s.mean_m, 0.8, 1e-12);
  EXPECT_NEAR(s.rmse_m, std::sqrt((0.01 + 0.09 + 0.25 + 0.81 + 4.84) / 5), 1e-12);
  EXPECT_NEAR(s.cep90_m, 0.9 + 0.6 * 1.3, 1e-12);
  EXPECT_NEAR(s.cep95_m, 0.9 + 0.8 * 1.3, 1e-12);
  EXPECT_DOUBLE_EQ(s.below_0_5, 0.4);
  EXPECT_DOUBLE_EQ(s.below_1, 0.8);
  // Sigma is 0.5 m: the radius of 50 % is 0.5887 m, that of 95 % 1.2239 m.
  EXPECT_DOUBLE_EQ(*s.coverage_50, 0.6);
  EXPECT_DOUBLE_EQ(*s.coverage_95, 0.8);
  EXPECT_NEAR(*s.anees, (0.04 + 0.36 + 1.0 + 3.24 + 19.36) / 5 / 2, 1e-12);
  EXPECT_NEAR(*s.best_of_5_median_m, 0.5, 1e-12);
}

TEST(ErrorStatistics, MissesStayInEveryDenominator) {
  std::vector<PointResult> results = results_of({off_by(0.1), no_fix(), off_by(0.3)});
  results.push_back(evaluate_point(TruthPoint(), nullptr));
  const ErrorStatistics s = compute_statistics(results, {}, {});
  EXPECT_EQ(s.n, 4U);
  EXPECT_EQ(s.missed, 2U);
  EXPECT_EQ(s.median_m, kInfinity);
  EXPECT_EQ(s.mean_m, kInfinity);
  EXPECT_EQ(s.rmse_m, kInfinity);
  EXPECT_NEAR(*s.located_mean_m, 0.2, 1e-12);
  EXPECT_DOUBLE_EQ(s.below_0_5, 0.5);
  EXPECT_DOUBLE_EQ(s.below_1, 0.5);
  EXPECT_DOUBLE_EQ(*s.coverage_50, 0.5);
  EXPECT_DOUBLE_EQ(*s.coverage_95, 0.5);
  EXPECT_EQ(*s.best_of_5_median_m, kInfinity);
}

TEST(ErrorStatistics, WithMissesOnlyThereIsNoMean) {
  const ErrorStatistics s = statistics_of({no_fix(), no_fix()});
  EXPECT_EQ(s.missed, 2U);
  EXPECT_FALSE(s.located_mean_m);
  EXPECT_FALSE(s.anees);
  EXPECT_EQ(s.below_1, 0.0);
}

TEST(ErrorStatistics, BestOfFiveUsesTheFiveHeaviestHypotheses) {
  LocationEstimate estimate = off_by(2.0);
  for (const double x : {2.0, 1.5, 0.25, 1.0, 3.0, 0.0}) {
    estimate.hypotheses.push_back({{x, 0, 0}, estimate.covariance, 0.1});
  }
  EXPECT_DOUBLE_EQ(*statistics_of({estimate}).best_of_5_median_m, 0.25);
}

TEST(ErrorStatistics, EstimatesWithoutUncertaintyHaveNoCoverage) {
  const ErrorStatistics s = statistics_of({unsure(0.2), unsure(0.4), no_fix()});
  EXPECT_NEAR(s.median_m, 0.4, 1e-12);
  EXPECT_FALSE(s.coverage_50);
  EXPECT_FALSE(s.coverage_95);
  EXPECT_FALSE(s.anees);
  EXPECT_FALSE(s.best_of_5_median_m);
  for (const char* name : {"coverage_50", "coverage_95", "anees", "best_of_5_median_m"}) {
    EXPECT_FALSE(s.ci95.contains(name)) << name;
  }
}

TEST(ErrorStatistics, AnEstimateWithoutUncertaintyAmongOthersIsNotCovered) {
  const ErrorStatistics s = statistics_of({off_by(0.1), unsure(0.1)});
  EXPECT_DOUBLE_EQ(*s.coverage_95, 0.5);
}

TEST(ErrorStatistics, SkillComparesTheMediansWithThoseOfTheControls) {
  Controls controls;
  controls.room_centre = {1.0, 2.0, 4.0};
  controls.fingerprint = {0.25, PointResult::kMissed, 0.5};
  const ErrorStatistics s = statistics_of({off_by(0.1), off_by(0.5), off_by(0.9)}, controls);
  EXPECT_DOUBLE_EQ(*s.room_centre_median_m, 2.0);
  EXPECT_NEAR(*s.skill_room_centre, 0.75, 1e-12);
  EXPECT_DOUBLE_EQ(*s.fingerprint_median_m, 0.5);
  EXPECT_NEAR(*s.skill_fingerprint, 0.0, 1e-12);
  EXPECT_FALSE(statistics_of({off_by(0.1)}).room_centre_median_m);
  EXPECT_FALSE(statistics_of({off_by(0.1)}).skill_fingerprint);
}

TEST(ErrorStatistics, IntervalsOfASkillAreOfBothMediansOnTheSameDraws) {
  // Twice as far at every point: whatever is drawn, the skill is one half.
  std::vector<LocationEstimate> estimates;
  Controls controls;
  for (int i = 1; i <= 20; ++i) {
    estimates.push_back(off_by(0.1 * i));
    controls.room_centre.push_back(0.2 * i);
  }
  const ErrorStatistics s = statistics_of(estimates, controls);
  EXPECT_NEAR(s.ci95.at("skill_room_centre")[0], 0.5, 1e-12);
  EXPECT_NEAR(s.ci95.at("skill_room_centre")[1], 0.5, 1e-12);
}

TEST(ErrorStatistics, DependentPointsAreResampledTogether) {
  std::vector<LocationEstimate> once;
  std::vector<LocationEstimate> thrice;
  for (int i = 1; i <= 30; ++i) {
    once.push_back(off_by(0.1 * i));
    thrice.insert(thrice.end(), 3, off_by(0.1 * i));
  }
  const auto of_once = compute_statistics(results_of(once), {}, {500, 1, 1});
  const auto of_thrice = compute_statistics(results_of(thrice), {}, {500, 1, 3});
  const auto as_if_independent = compute_statistics(results_of(thrice), {}, {500, 1, 1});
  for (std::size_t end = 0; end < 2; ++end) {
    EXPECT_NEAR(of_thrice.ci95.at("mean_m")[end], of_once.ci95.at("mean_m")[end], 1e-9);
  }
  EXPECT_GT(as_if_independent.ci95.at("mean_m")[0], of_once.ci95.at("mean_m")[0]);
}

TEST(ErrorStatistics, EveryFigureHasAnInterval) {
  const ErrorStatistics s =
      statistics_of({off_by(0.1), off_by(0.2)}, Controls{{1.0, 2.0}, {0.5, 0.6}});
  for (const char* name : {"median_m",
                           "mean_m",
                           "rmse_m",
                           "located_mean_m",
                           "located_rmse_m",
                           "cep50_m",
                           "cep90_m",
                           "cep95_m",
                           "below_0_5",
                           "below_1",
                           "coverage_50",
                           "coverage_95",
                           "anees",
                           "best_of_5_median_m",
                           "room_centre_median_m",
                           "fingerprint_median_m",
                           "skill_room_centre",
                           "skill_fingerprint"}) {
    EXPECT_TRUE(s.ci95.contains(name)) << name;
  }
  EXPECT_EQ(s.ci95.size(), 18U);
}

TEST(ErrorStatistics, IntervalsHoldTheFigureAndRepeat) {
  std::vector<LocationEstimate> estimates;
  for (int i = 1; i <= 50; ++i) {
    estimates.push_back(off_by(0.02 * i));
  }
  const ErrorStatistics s = statistics_of(estimates);
  const auto median = s.ci95.at("median_m");
  EXPECT_LT(median[0], s.median_m);
  EXPECT_GT(median[1], s.median_m);
  // For a uniform distribution on [0, 1] the median of 50 has a standard deviation of 0.07.
  EXPECT_NEAR(median[1] - median[0], 4 * 0.07, 0.1);
  EXPECT_EQ(statistics_of(estimates).ci95, s.ci95);
}

}  // namespace
}  // namespace rayloc::error_statistics_test
