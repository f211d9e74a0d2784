#include "engine/posterior/tempering_exponent.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace rayloc::tempering_exponent_test {
namespace {

constexpr std::size_t kPoints = 140;
constexpr double kSigma = 0.08;  // [m], of what is estimated with the exponent 1
constexpr std::array kOneWidth = {0.01};

struct Survey {
  KnownPlaces known;
  std::vector<Vec3d> estimated;
};

// Estimates `error` [m] on each axis off the places, which are stated `place_sigma` [m] off.
Survey survey(double error, double place_sigma, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Survey result{{{}, place_sigma, 12.0}, {}};
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vec3d truth{0.02 * static_cast<double>(i), 1.0, 0.0};
    result.estimated.push_back(truth + error * Vec3d{normal(random), normal(random), 0.0});
    result.known.places.push_back(truth + place_sigma * Vec3d{normal(random), normal(random), 0.0});
  }
  return result;
}

// As a likelihood to the power of `exponent` states them.
std::vector<LocationEstimate> estimates(const Survey& survey, double exponent, double left_over) {
  std::vector<LocationEstimate> all;
  const double variance = kSigma * kSigma / exponent + kOneWidth[0] * kOneWidth[0];
  for (const Vec3d& position : survey.estimated) {
    LocationEstimate& estimate = all.emplace_back();
    estimate.position = position;
    estimate.covariance = {variance, 0, 0, 0, variance, 0, 0, 0, 1e-4};
    estimate.hypotheses = {{position, estimate.covariance, 1.0 - left_over}};
    estimate.residual_probability = left_over;
  }
  return all;
}

std::vector<TemperingExponent> evaluate_all(const Survey& survey) {
  std::vector<TemperingExponent> evaluated;
  evaluated.reserve(kExponents.size());
  for (const double exponent : kExponents) {
    evaluated.push_back(evaluate_exponent(
        exponent, estimates(survey, exponent, 0.01), kOneWidth[0], survey.known, kOneWidth));
  }
  return evaluated;
}

double chosen(const Survey& survey) {
  const auto evaluated = evaluate_all(survey);
  return evaluated[best_exponent(evaluated)].exponent;
}

TEST(TemperingExponent, MatchesEstimateWidthsToTheirErrors) {
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    EXPECT_GE(chosen(survey(kSigma, 0.0, seed)), 0.8) << seed;
    const double wide = chosen(survey(2.0 * kSigma, 0.0, seed));  // 0.25 by construction
    EXPECT_GE(wide, 0.18) << seed;
    EXPECT_LE(wide, 0.35) << seed;
  }
}

TEST(TemperingExponent, DoesNotTakeTheSurveyForAnError) {
  Survey exact = survey(kSigma, 0.1);
  EXPECT_GE(chosen(exact), 0.8);
  exact.known.place_sigma = 0.0;  // as if the places were certain
  EXPECT_LE(chosen(exact), 0.6);
}

TEST(TemperingExponent, CalibratedRegionsHaveADishonestyOfAboutOne) {
  double sum = 0.0;
  constexpr unsigned kSurveys = 40;
  for (unsigned seed = 0; seed < kSurveys; ++seed) {
    const Survey one = survey(std::hypot(kSigma, kOneWidth[0]), 0.0, seed);
    sum += evaluate_exponent(1.0, estimates(one, 1.0, 0.0), kOneWidth[0], one.known, kOneWidth)
               .dishonesty;
  }
  // The statistic of Anderson and Darling has a mean of 1 and a standard deviation of 0.76.
  EXPECT_NEAR(sum / kSurveys, 1.0, 4.0 * 0.76 / std::sqrt(kSurveys));
  const auto evaluated = evaluate_all(survey(kSigma, 0.0));
  EXPECT_GT(evaluated.back().dishonesty, 20.0);  // regions four times too wide
}

TEST(TemperingExponent, FindsTheWidthThatIsLeft) {
  const Survey one = survey(std::hypot(kSigma, 0.03), 0.0);
  const auto evaluated = evaluate_exponent(1.0, estimates(one, 1.0, 0.0), kOneWidth[0], one.known);
  EXPECT_GE(evaluated.sigma_floor, 0.014);
}

TEST(TemperingExponent, CountsAPointWithoutAFixAsUniform) {
  const Survey one = survey(kSigma, 0.0);
  auto all = estimates(one, 1.0, 0.0);
  all.front() = {};
  const auto evaluated = evaluate_exponent(1.0, all, kOneWidth[0], one.known, kOneWidth);
  EXPECT_NEAR(evaluated.scores.front(), -std::log(one.known.area), 1e-12);
}

// Worse than 0 by `mean` [nat] a point, by 0.3 more at every other one and by 0.3 less at the rest:
// the standard error of 20 points is 0.07.
TemperingExponent evaluated(double exponent, double dishonesty, double mean) {
  TemperingExponent one{exponent, 0.01, {}, -mean, dishonesty};
  for (int i = 0; i < 20; ++i) {
    one.scores.push_back(mean == 0.0 ? 0.0 : -mean + (i % 2 == 0 ? 0.3 : -0.3));
  }
  return one;
}

TEST(BestExponent, IsTheBestCalibratedOfEqualScores) {
  const std::vector all = {
      evaluated(1.0, 5.0, 0.0), evaluated(0.8, 1.0, 0.05), evaluated(0.6, 3.0, 0.05)};
  EXPECT_EQ(best_exponent(all), 1U);
}

TEST(BestExponent, IsTheSmallestCalibratedOne) {
  const std::vector all = {
      evaluated(1.0, 1.0, 0.0), evaluated(0.8, 1.5, 0.05), evaluated(0.6, 2.0, 0.05)};
  EXPECT_EQ(best_exponent(all), 1U);
}

TEST(BestExponent, IgnoresExponentsWithAWorseScore) {
  const std::vector all = {evaluated(1.0, 5.0, 0.0), evaluated(0.8, 0.5, 0.1)};
  EXPECT_EQ(best_exponent(all), 0U);
}

}  // namespace
}  // namespace rayloc::tempering_exponent_test
