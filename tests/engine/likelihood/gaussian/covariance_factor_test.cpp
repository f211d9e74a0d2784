#include "engine/likelihood/gaussian/covariance_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

namespace rayloc::covariance_factor_test {
namespace {

using Value = std::complex<double>;

// Positive definite, of determinant 17.75; only its lower triangle is given.
Eigen::MatrixXcd covariance() {
  Eigen::MatrixXcd sigma = Eigen::MatrixXcd::Constant(3, 3, Value(std::nan(""), 0.0));
  sigma(0, 0) = 4.0;
  sigma(1, 0) = Value(1.0, 1.0);
  sigma(1, 1) = 3.0;
  sigma(2, 0) = Value(0.0, -0.5);
  sigma(2, 1) = Value(0.5, 0.0);
  sigma(2, 2) = 2.0;
  return sigma;
}

TEST(CovarianceFactor, WhitensTheCovariance) {
  const CovarianceFactor factor(covariance());
  const Eigen::MatrixXcd sigma = covariance().selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXcd& w = factor.whitener();
  const Eigen::MatrixXcd identity = w * sigma * w.adjoint();
  EXPECT_NEAR((identity - Eigen::MatrixXcd::Identity(3, 3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(factor.log_determinant(), std::log(17.75), 1e-12);  // by hand
}

TEST(CovarianceFactor, MakesAGaussianOfZeroMean) {
  const CovarianceFactor factor(covariance());
  const WhitenedGaussian gaussian = factor.gaussian();
  EXPECT_EQ(gaussian.whitener.size(), 6U);
  EXPECT_TRUE(gaussian.mean.empty());
  EXPECT_EQ(gaussian.log_determinant, factor.log_determinant());
  const std::vector<Value> y{{1.0, 2.0}, {-1.0, 0.5}, {0.0, 3.0}};
  const auto u = whiten(gaussian, y);
  const Eigen::VectorXcd expected =
      factor.whitener() * Eigen::Map<const Eigen::VectorXcd>(y.data(), 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(u[static_cast<std::size_t>(i)] - expected(i)), 0.0, 1e-5);
  }
}

}  // namespace
}  // namespace rayloc::covariance_factor_test
