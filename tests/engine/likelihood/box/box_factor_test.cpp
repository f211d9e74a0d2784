#include "engine/likelihood/box/box_factor.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "engine/likelihood/gaussian/covariance_factor.h"

namespace rayloc::box_factor_test {
namespace {

using Value = std::complex<double>;
using Eigen::Index;

constexpr double kNoise = 1e-4;  // on the diagonal

// The same covariance of random rays in both forms.
struct Both {
  BoxFactor factor;
  Eigen::MatrixXcd sigma;

  explicit Both(std::size_t dimension)
      : factor(dimension),
        sigma(kNoise * Eigen::MatrixXcd::Identity(static_cast<Index>(dimension),
                                                  static_cast<Index>(dimension))) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    const std::size_t rays = 13;
    const std::size_t stride = BoxFactor::padded(dimension);
    std::vector<double> re(rays * stride);
    std::vector<double> im(rays * stride);
    for (std::size_t p = 0; p < rays; ++p) {
      Eigen::VectorXcd ray(static_cast<Index>(dimension));
      for (std::size_t i = 0; i < dimension; ++i) {
        const Value value(0.1 * normal(random), 0.1 * normal(random));
        re[p * stride + i] = value.real();
        im[p * stride + i] = value.imag();
        ray(static_cast<Index>(i)) = value;
      }
      sigma += ray * ray.adjoint();
    }
    factor.add(re, im);
    for (std::size_t i = 0; i < dimension; ++i) {
      factor.add(i, i, kNoise);
    }
    factor.factorise();
  }
};

void expect_equal(const Both& both) {
  const std::size_t size = both.factor.dimension();
  const CovarianceFactor expected(both.sigma);
  // The condition of the covariance times the rounding of doubles leaves this much.
  const double tolerance = 1e-9 * expected.whitener().cwiseAbs().maxCoeff();
  std::vector<Value> x;
  Eigen::VectorXcd same(static_cast<Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    x.emplace_back(std::cos(1.0 * static_cast<double>(i)), 0.3);
    same(static_cast<Index>(i)) = x.back();
    for (std::size_t j = 0; j <= i; ++j) {
      EXPECT_LT(std::abs(both.factor.whitener(i, j) -
                         expected.whitener()(static_cast<Index>(i), static_cast<Index>(j))),
                tolerance)
          << i << " " << j;
    }
  }
  EXPECT_NEAR(both.factor.log_determinant(), expected.log_determinant(), 1e-8);
  const std::vector<Value> whitened = both.factor.whiten(x);
  const Eigen::VectorXcd as_eigen = expected.whitener() * same;
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_LT(std::abs(whitened[i] - as_eigen(static_cast<Index>(i))),
              static_cast<double>(size) * tolerance);
  }
}

TEST(BoxFactor, WhitensAsTheExactFactor) {
  for (const std::size_t dimension : {1U, 4U, 6U, 17U, 18U, 24U, 40U, 96U}) {
    SCOPED_TRACE(dimension);
    expect_equal(Both(dimension));
  }
}

TEST(BoxFactor, PhasorsAreThoseOfTheLibrary) {
  std::vector<double> turns(21);
  for (std::size_t i = 0; i < turns.size(); ++i) {
    turns[i] = -30.0 + 3.17 * static_cast<double>(i);
  }
  std::vector<double> re(turns.size());
  std::vector<double> im(turns.size());
  unit_phasors(turns, re, im);
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Value expected = std::polar(1.0, -2.0 * std::numbers::pi * turns[i]);
    EXPECT_NEAR(re[i], expected.real(), 1e-13);
    EXPECT_NEAR(im[i], expected.imag(), 1e-13);
  }
}

class BoxFactorTargets : public ::testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(BoxFactorTargets, EveryKindOfProcessor) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2U);
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    expect_equal(Both(18));
  }
}

}  // namespace
}  // namespace rayloc::box_factor_test
