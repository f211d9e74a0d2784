// WhitenedGaussian: a complex Gaussian with a mean, stored as its whitening transform.
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
  std::vector<std::complex<float>> mean;      // W mu; empty: zero mean
  double mean_power = 0.0;                    // |W mu|^2
  double log_determinant = 0.0;               // of Sigma
};

// W y
std::vector<std::complex<double>> whiten(std::span<const std::complex<float>> whitener,
                                         std::span<const std::complex<double>> y);
std::vector<std::complex<double>> whiten(const WhitenedGaussian& gaussian,
                                         std::span<const std::complex<double>> y);
// W^H u
std::vector<std::complex<double>> unwhiten(std::span<const std::complex<float>> whitener,
                                           std::span<const std::complex<double>> u);

// a^H b
std::complex<double> inner_product(std::span<const std::complex<double>> a,
                                   std::span<const std::complex<double>> b);
// |x|^2
double power_of(std::span<const std::complex<double>> x);

}  // namespace rayloc
