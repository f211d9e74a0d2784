#include "engine/likelihood/gaussian/covariance_factor.h"

#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

#include "engine/base/check.h"

namespace rayloc {

CovarianceFactor::CovarianceFactor(const Eigen::MatrixXcd& sigma) {
  const Eigen::LLT<Eigen::MatrixXcd> cholesky(sigma);
  RAYLOC_CHECK(cholesky.info() == Eigen::Success);
  whitener_ = cholesky.matrixL().solve(Eigen::MatrixXcd::Identity(sigma.rows(), sigma.rows()));
}

double CovarianceFactor::log_determinant() const {
  double result = 0.0;
  for (Eigen::Index i = 0; i < whitener_.rows(); ++i) {
    result -= 2.0 * std::log(whitener_(i, i).real());
  }
  return result;
}

WhitenedGaussian CovarianceFactor::gaussian() const {
  const Eigen::Index size = whitener_.rows();
  WhitenedGaussian gaussian;
  gaussian.whitener.reserve(static_cast<std::size_t>(size * (size + 1) / 2));
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      gaussian.whitener.emplace_back(whitener_(i, j));
    }
  }
  gaussian.log_determinant = log_determinant();
  return gaussian;
}

}  // namespace rayloc
