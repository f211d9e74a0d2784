// Gaussian mixture with diagonal covariances, by expectation maximisation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace rayloc {

struct MixtureComponent {
  double share = 0.0;
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;  // of each coordinate
};

struct GaussianMixture {
  std::vector<MixtureComponent> components;
  double mean_log_likelihood = 0.0;  // of a point
};

struct MixtureOptions {
  std::size_t components = 5;
  std::uint64_t seed = 1;  // of the starts, drawn as in k-means++
  std::size_t most_rounds = 200;
  double least_gain = 1e-6;      // of the mean log-likelihood in a round; less ends the fit
  double least_variance = 1e-6;  // added to each, so that a component of one point has a density
};

// `points`: [coordinate][point]. At most as many components as points; empty ones are removed.
GaussianMixture fit_mixture(const Eigen::MatrixXd& points, const MixtureOptions& options);

}  // namespace rayloc
