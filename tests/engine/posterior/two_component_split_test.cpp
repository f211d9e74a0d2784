#include "engine/posterior/two_component_split.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rayloc::two_component_split_test {
namespace {

struct Hill {
  double weight;
  double x;
  double sigma;
};

// Squares of 2 mm with the mass of round Gaussians.
std::vector<HillMass> parts_of(const std::vector<Hill>& hills) {
  constexpr double kStep = 0.002;
  constexpr int kReach = 100;
  std::vector<HillMass> parts;
  for (int i = -kReach; i <= kReach; ++i) {
    for (int j = -kReach; j <= kReach; ++j) {
      HillMass part{0.0, kStep * i, kStep * j, 0.0, 0.0, 0.0};
      part.xx = part.yy = kStep * kStep / 12.0;
      for (const Hill& hill : hills) {
        const double d2 = (part.x - hill.x) * (part.x - hill.x) + part.y * part.y;
        part.mass += hill.weight * kStep * kStep / (hill.sigma * hill.sigma) *
                     std::exp(-0.5 * d2 / (hill.sigma * hill.sigma));
      }
      parts.push_back(part);
    }
  }
  return parts;
}

TEST(TwoComponentSplit, OneGaussianIsNotSplit) {
  EXPECT_FALSE(two_component_split(parts_of({{1.0, 0.0, 0.03}})));
  EXPECT_FALSE(two_component_split(std::vector<HillMass>{{1.0, 0.3, 0.2, 1e-4, 0.0, 1e-4}}));
}

TEST(TwoComponentSplit, RecoversBothComponents) {
  const auto parts = parts_of({{0.8, 0.01, 0.005}, {0.2, -0.01, 0.05}});
  const auto two = two_component_split(parts);
  ASSERT_TRUE(two);
  const auto& [core, foot] = *two;
  const HillMass whole = sum_of(parts);
  EXPECT_NEAR(core.mass + foot.mass, whole.mass, 1e-9 * whole.mass);
  EXPECT_NEAR(core.mass / whole.mass, 0.8, 0.01);
  EXPECT_NEAR(core.x, 0.01, 2e-4);
  EXPECT_NEAR(std::sqrt(core.xx), 0.005, 2e-4);
  EXPECT_NEAR(foot.x, -0.01, 2e-3);
  EXPECT_NEAR(std::sqrt(foot.yy), 0.05, 2e-3);
}

// Mean and covariance of both together are those of the hill.
TEST(TwoComponentSplit, KeepsTheMomentsOfThePeak) {
  const auto parts = parts_of({{0.6, 0.02, 0.01}, {0.4, -0.02, 0.06}});
  const auto two = two_component_split(parts);
  ASSERT_TRUE(two);
  const HillMass whole = sum_of(parts);
  const HillMass again = sum_of(*two);
  EXPECT_NEAR(again.x, whole.x, 1e-4);
  EXPECT_NEAR(again.xx, whole.xx, 0.01 * whole.xx);
  EXPECT_NEAR(again.yy, whole.yy, 0.01 * whole.yy);
}

}  // namespace
}  // namespace rayloc::two_component_split_test
