#include "engine/paper/rmsprop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayloc::paper::rmsprop_test {
namespace {

TEST(Rmsprop, StepLengthDependsOnlyOnTheRate) {
  Rmsprop descent({1e-3, 0.2}, {.decay = 0.9, .momentum = 0.0, .least = 1e-12});
  std::vector<double> x = {1.0, 1.0};
  descent.step(std::vector{500.0, -0.01}, x);
  EXPECT_NEAR(x[0], 1.0 - 1e-3, 1e-9);
  EXPECT_NEAR(x[1], 1.0 + 0.2, 1e-9);
  // s = 0.9 * 0.1 g^2 + 0.1 (3 g)^2 over 1 - 0.9^2.
  descent.step(std::vector{1500.0, -0.03}, x);
  const double step = 3.0 / std::sqrt((0.09 + 0.9) / 0.19);
  EXPECT_NEAR(x[0], 1.0 - 1e-3 * (1.0 + step), 1e-9);
  EXPECT_NEAR(x[1], 1.0 + 0.2 * (1.0 + step), 1e-9);
}

TEST(Rmsprop, MomentumCarriesOn) {
  Rmsprop descent({1.0}, {.decay = 0.0, .momentum = 0.6, .least = 1e-12});
  std::vector<double> x = {0.0};
  descent.step(std::vector{2.0}, x);
  descent.step(std::vector{0.0}, x);
  EXPECT_NEAR(x[0], -1.6, 1e-9);
}

TEST(Rmsprop, BarelyMovesForTinyGradients) {
  Rmsprop descent({1.0}, {.decay = 0.9, .momentum = 0.6, .least = 1e-6});
  std::vector<double> x = {0.0};
  for (int i = 0; i < 100; ++i) {
    descent.step(std::vector{1e-12}, x);
  }
  EXPECT_LT(std::abs(x[0]), 1e-3);
}

TEST(Rmsprop, FindsTheLowestPlaceOfAValley) {
  Rmsprop descent({0.01, 0.01}, {});
  std::vector<double> x = {1.0, -1.0};
  for (int i = 0; i < 300; ++i) {
    descent.step(std::vector{2.0 * (x[0] - 0.3), 200.0 * (x[1] - 0.5)}, x);
  }
  EXPECT_NEAR(x[0], 0.3, 0.05);
  EXPECT_NEAR(x[1], 0.5, 0.05);
}

}  // namespace
}  // namespace rayloc::paper::rmsprop_test
