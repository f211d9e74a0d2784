// WhitenedGaussian: complex Gaussians of one covariance, stored as its whitening transform.
//
// CovarianceFactor makes it. The means are the caller's: a place of a device whitens them in double
// precision (PlaceMoments), a place of a person by the rounded transform (PersonLikelihood).
//
// Triangles are lower triangles by rows: n (n + 1) / 2 values.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace rayloc {

// Inverse Cholesky factor W of the covariance Sigma, Sigma^-1 = W^H W, and derived values.
struct WhitenedGaussian {
  std::vector<std::complex<float>> whitener;  // W, a triangle
  std::vector<std::complex<float>> mean;      // W mu of each Gaussian, one by one; empty: zero mean
  double log_determinant = 0.0;               // of Sigma
};

// W y
std::vector<std::complex<double>> whiten(const WhitenedGaussian& gaussian,
                                         std::span<const std::complex<double>> y);
// W^H u
std::vector<std::complex<double>> unwhiten(const WhitenedGaussian& gaussian,
                                           std::span<const std::complex<double>> u);

// a^H b
std::complex<double> inner_product(std::span<const std::complex<double>> a,
                                   std::span<const std::complex<double>> b);
// |x|^2
double power_of(std::span<const std::complex<double>> x);

}  // namespace rayloc
