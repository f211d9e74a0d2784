// CovarianceFactor: inverse Cholesky factor W of a covariance Sigma, Sigma^-1 = W^H W, in double
// precision.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <Eigen/Core>

#include "engine/likelihood/gaussian/whitened_gaussian.h"

namespace rayloc {

class CovarianceFactor {
 public:
  // Reads the lower triangle. REQUIRES: sigma is positive definite.
  explicit CovarianceFactor(const Eigen::MatrixXcd& sigma);

  const Eigen::MatrixXcd& whitener() const { return whitener_; }  // W, zero above its diagonal
  double log_determinant() const;                                 // of Sigma, natural logarithm

  // A Gaussian with this covariance and zero mean.
  WhitenedGaussian gaussian() const;

 private:
  Eigen::MatrixXcd whitener_;
};

}  // namespace rayloc
