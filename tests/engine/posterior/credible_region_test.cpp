#include "engine/posterior/credible_region.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace rayloc::credible_region_test {
namespace {

std::array<double, 9> covariance(double xx, double xy, double yy) {
  return {xx, xy, 0, xy, yy, 0, 0, 0, 1e-4};
}

LocationEstimate single(double weight = 1.0) {
  LocationEstimate estimate;
  estimate.position = Vec3d{1, 2, 1.2};
  estimate.covariance = covariance(0.04, 0.01, 0.09);
  if (weight < 1.0) {
    estimate.hypotheses.push_back({*estimate.position, estimate.covariance, weight});
    estimate.residual_probability = 1.0 - weight;
  }
  return estimate;
}

TEST(CredibleRegion, IsTheEllipseOfAGaussian) {
  // d^2 = dx^2 yy - 2 dx dy xy + dy^2 xx over the determinant, by hand.
  const double d2 = (0.3 * 0.3 * 0.09 - 2 * 0.3 * 0.2 * 0.01 + 0.2 * 0.2 * 0.04) / 0.0035;
  EXPECT_NEAR(*normalized_squared_error(single(), {1.3, 2.2, 7}), d2, 1e-12);
  EXPECT_NEAR(*region_reaching(single(), {1.3, 2.2, 7}), 1 - std::exp(-d2 / 2), 1e-12);
  EXPECT_EQ(*region_reaching(single(), {1, 2, 0}), 0.0);
}

TEST(CredibleRegion, DensityIncludesTheGaussianAndTheResidual) {
  const double d2 = (0.3 * 0.3 * 0.09 - 2 * 0.3 * 0.2 * 0.01 + 0.2 * 0.2 * 0.04) / 0.0035;
  const double gaussian = std::exp(-d2 / 2) / (2 * M_PI * std::sqrt(0.0035));
  EXPECT_NEAR(stated_density(single(0.8), {1.3, 2.2, 0}, 10.0), 0.8 * gaussian + 0.02, 1e-12);
  EXPECT_NEAR(stated_density(single(0.8), {100, 100, 0}, 10.0), 0.02, 1e-12);
  LocationEstimate none;
  EXPECT_NEAR(stated_density(none, {1, 2, 0}, 10.0), 0.1, 1e-12);
}

TEST(CredibleRegion, LeftOverProbabilityComesLast) {
  const double full = *region_reaching(single(), {1.3, 2.2, 0});
  EXPECT_NEAR(*region_reaching(single(0.8), {1.3, 2.2, 0}), 0.8 * full, 1e-12);
  // However far: the region of more than 0.8 is everything.
  EXPECT_NEAR(*region_reaching(single(0.8), {100, 100, 0}), 0.8, 1e-12);
}

TEST(CredibleRegion, ContainsItsProbabilityForAMixture) {
  // Draws of the mixture itself lie in its region of probability p with probability p.
  LocationEstimate estimate = single();
  estimate.hypotheses = {{{0, 0, 0}, covariance(0.01, 0.002, 0.02), 0.5},
                         {{1, 0.1, 0}, covariance(0.04, 0, 0.01), 0.3},
                         {{0.2, 0.1, 0}, covariance(0.09, -0.01, 0.09), 0.1}};
  estimate.residual_probability = 0.1;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  constexpr int kDraws = 1500;
  int in_50 = 0;
  int in_90 = 0;
  int in_95 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double u = uniform(random);
    Vec3d truth{50, 50, 0};  // somewhere else
    if (u < 0.9) {
      const Hypothesis& h = estimate.hypotheses[u < 0.5 ? 0 : u < 0.8 ? 1 : 2];
      const double l11 = std::sqrt(h.covariance[0]);
      const double l21 = h.covariance[1] / l11;
      const double l22 = std::sqrt(h.covariance[4] - l21 * l21);
      const double a = normal(random);
      const double b = normal(random);
      truth = {h.position.x + l11 * a, h.position.y + l21 * a + l22 * b, 0};
    }
    const double reached = *region_reaching(estimate, truth);
    in_50 += reached < 0.5 ? 1 : 0;
    in_90 += reached < 0.89 ? 1 : 0;
    in_95 += reached < 0.95 ? 1 : 0;
  }
  // Four standard deviations of the draws, and 0.01 of the quadrature.
  EXPECT_NEAR(in_50 / static_cast<double>(kDraws), 0.5, 0.062);
  EXPECT_NEAR(in_90 / static_cast<double>(kDraws), 0.89, 0.042);
  EXPECT_EQ(in_95, kDraws);
}

TEST(CredibleRegion, AMixtureOfEqualPartsIsTheirGaussian) {
  LocationEstimate two = single();
  two.hypotheses = {{*two.position, two.covariance, 0.5}, {*two.position, two.covariance, 0.5}};
  two.residual_probability = 0.0;
  for (const double x : {1.05, 1.2, 1.4, 1.7}) {
    EXPECT_NEAR(*region_reaching(two, {x, 2, 0}), *region_reaching(single(), {x, 2, 0}), 0.012)
        << x;
  }
}

TEST(CredibleRegion, NothingIsStatedWithoutAPositionOrACovariance) {
  EXPECT_FALSE(region_reaching(LocationEstimate(), {}));
  LocationEstimate estimate = single();
  for (const auto& bad :
       {covariance(0, 0, 0), covariance(-1, 0, 1), covariance(1, 1, 1), covariance(1, 2, 1)}) {
    estimate.covariance = bad;
    EXPECT_FALSE(region_reaching(estimate, {}));
    EXPECT_FALSE(normalized_squared_error(estimate, {}));
  }
}

}  // namespace
}  // namespace rayloc::credible_region_test
