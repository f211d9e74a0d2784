// The effect of an echo that the model lacks on the stated place of a surface.
#include "engine/calibrate/joint/reported_sigma.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "engine/scene/scene.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::reported_sigma_test {
namespace {

constexpr double kHalfWave = 0.029;  // [m]
constexpr double kWidth = 0.001;     // [m], of the Gaussian

class StatedWidthsTest : public ::testing::Test {
 protected:
  // The width of surface 0, which carries that share of the power and is at `offset` [m].
  double width(double carried, double unexplained, double offset = 0.0) const {
    JointState state;
    state.values.resize(unknowns_.size());
    state.values[unknowns_.surface_offset(0)] = offset;
    std::vector<double> sigma(unknowns_.size());
    sigma[unknowns_.surface_offset(0)] = kWidth;
    widen_by_unmodelled_echo(
        unknowns_,
        {std::vector<double>(room_.plan.scene->surfaces().size(), carried), unexplained, kHalfWave},
        state,
        sigma);
    return sigma[unknowns_.surface_offset(0)];
  }

  test::SurveyedRoom room_ = test::make_surveyed_room({.points = 4, .trace = {.max_depth = 1}});
  RoomUnknowns unknowns_{room_.plan, {}};
  double prior_ = unknowns_[unknowns_.surface_offset(0)].sigma;
};

TEST_F(StatedWidthsTest, ARoomThatExplainsAllKeepsTheGaussian) {
  EXPECT_NEAR(width(0.1, 0.0), kWidth, 1e-12);
}

TEST_F(StatedWidthsTest, GrowWithTheUnexplainedShare) {
  double before = kWidth;
  for (const double unexplained : {0.02, 0.05, 0.1, 0.2, 0.5}) {
    const double now = width(0.1, unexplained);
    EXPECT_GT(now, before) << unexplained;
    before = now;
  }
}

TEST_F(StatedWidthsTest, AFaintSurfaceHasThePriorWidth) {
  const double width_now = width(1e-7, 0.3);
  EXPECT_GT(width_now, 0.8 * prior_);
  EXPECT_LT(width_now, 1.3 * prior_);
}

// A surface beyond its prior is more probably a cycle nearer to the plan.
TEST_F(StatedWidthsTest, AFaintSurfaceFarFromThePlanIsWider) {
  EXPECT_GT(width(0.01, 0.3, 2.0 * prior_), 1.3 * width(0.01, 0.3, 0.0));
}

// By drawing, as below: an echo at the array turns all of its antenna's channel, at every point.
TEST_F(StatedWidthsTest, AnEchoOfTheWholeArrayWidensAChain) {
  constexpr double kUnexplained = 0.08;
  std::vector<double> sigma(unknowns_.size());
  const std::uint32_t gain = unknowns_.chain_gain(0, 1);
  sigma[gain] = sigma[gain + 1] = kWidth;
  JointState state;
  state.values.resize(unknowns_.size());
  widen_by_unmodelled_echo(
      unknowns_,
      {std::vector<double>(room_.plan.scene->surfaces().size(), 0.1), kUnexplained, kHalfWave},
      state,
      sigma);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  double squares = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double phase = std::arg(1.0 + std::polar(std::sqrt(0.15 * kUnexplained), turn(random)));
    squares += phase * phase;
  }
  const double expected = std::hypot(kWidth, std::sqrt(squares / kDraws));
  EXPECT_NEAR(sigma[gain], expected, 0.02 * expected);      // natural logarithm
  EXPECT_NEAR(sigma[gain + 1], expected, 0.02 * expected);  // [rad]
}

TEST_F(StatedWidthsTest, UnreleasedParametersStayUnstated) {
  std::vector<double> sigma(unknowns_.size());
  JointState state;
  state.values.resize(unknowns_.size());
  widen_by_unmodelled_echo(
      unknowns_,
      {std::vector<double>(room_.plan.scene->surfaces().size(), 0.1), 0.5, kHalfWave},
      state,
      sigma);
  for (const double one : sigma) {
    EXPECT_EQ(one, 0.0);
  }
}

// By drawing: the phase of an echo plus a weaker one of random phase, as an offset.
TEST_F(StatedWidthsTest, AWeakEchoWidensTheOffsetByItsPhase) {
  constexpr double kCarried = 1.0;
  constexpr double kUnexplained = 0.2;  // the mean echo is 0.03 of it
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  double squares = 0.0;
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    const double amplitude = std::sqrt(0.15 * kUnexplained / kCarried);
    const double phase = turn(random);
    const double rotated =
        std::atan2(amplitude * std::sin(phase), 1.0 + amplitude * std::cos(phase));
    const double offset = rotated / (2.0 * std::numbers::pi) * kHalfWave;
    squares += offset * offset;
  }
  const double expected = std::hypot(kWidth, std::sqrt(squares / kDraws));
  EXPECT_NEAR(width(kCarried, kUnexplained), expected, 0.01 * expected);
}

}  // namespace
}  // namespace rayloc::reported_sigma_test
