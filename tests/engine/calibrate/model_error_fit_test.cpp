#include "engine/calibrate/model_error_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rayloc::model_error_fit_test {
namespace {

double octaves(double value, double from) { return std::log2(value / from); }

// A narrow valley: more diffuse power that lasts less long explains nearly as much. One after the
// other would take tens of rounds along it.
TEST(ModelErrorFit, FollowsCorrelatedParameters) {
  constexpr double kAlong = 0.2;    // octaves, standard deviation along the valley
  constexpr double kAcross = 0.02;  // and across
  const auto evidence = [](const ModelError& error) {
    const double diffuse = octaves(error.diffuse, 0.4);
    const double decay = octaves(error.diffuse_decay, 9e-9);
    const double along = (diffuse - decay) / std::numbers::sqrt2 / kAlong;
    const double across = (diffuse + decay) / std::numbers::sqrt2 / kAcross;
    return -0.5 * (along * along + across * across);
  };
  const FittedModelError fit = fit_model_error(evidence, assumed_model_error());
  EXPECT_NEAR(fit.diffuse.value, 0.4, 0.01);
  EXPECT_NEAR(fit.diffuse_decay.value, 9e-9, 0.2e-9);
  EXPECT_EQ(fit.diffuse.prior, ModelError{}.diffuse);
  // For any value of the other number: the valley's length, not its width.
  EXPECT_NEAR(fit.diffuse.sigma / fit.diffuse.value,
              std::numbers::ln2 * kAlong / std::numbers::sqrt2,
              0.01);
}

TEST(ModelErrorFit, ReturnsThePriorWithoutInformation) {
  const auto fit = fit_model_error([](const ModelError&) { return 7.0; }, assumed_model_error());
  EXPECT_NEAR(fit.noise.value, ModelError{}.noise, 1e-5);
  EXPECT_NEAR(fit.diffuse_exponent.value, 0.0, 1e-3);
  EXPECT_NEAR(fit.diffuse_exponent.sigma, 1.0, 0.05);
  EXPECT_GT(fit.noise.sigma, fit.noise.value);
}

// Nothing that is fitted vanishes, however much that would explain.
TEST(ModelErrorFit, EndsAboveItsFloors) {
  const auto fit = fit_model_error(
      [](const ModelError& error) {
        EXPECT_GT(error.noise, 1e-4);
        EXPECT_GT(error.plan_tolerance, 0.4e-3);
        return -100.0 * std::log(error.noise * error.plan_tolerance * error.diffuse);
      },
      assumed_model_error());
  EXPECT_LT(fit.noise.value, 1.5e-4);
  EXPECT_LT(fit.plan_tolerance.value, 1e-3);
  EXPECT_LT(fit.diffuse.value, 3e-3);
}

}  // namespace
}  // namespace rayloc::model_error_fit_test
