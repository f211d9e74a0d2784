// PlaceMoments: mean and covariance of what is measured at a place, while its rays are added up.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "engine/likelihood/place_model.h"

namespace rayloc {

struct PlaceMean {
  Eigen::VectorXcd all;
  Eigen::VectorXcd direct;  // of the way that may be covered; of size 0: there is none
};

struct PlaceMoments {
  explicit PlaceMoments(Eigen::Index size)
      : sigma(Eigen::MatrixXcd::Zero(size, size)), mean{Eigen::VectorXcd::Zero(size), {}} {}

  // What is unknown of each ray, a column: times its conjugate transpose.
  void add(const Eigen::MatrixXcd& unknown) {
    sigma.selfadjointView<Eigen::Lower>().rankUpdate(unknown);
  }

  // With what is not traced: the diffuse power spread by `covariance` over the delays of each
  // antenna, [q][q], and `noise` in all.
  PlaceModel factorised(std::size_t antennas,
                        const std::vector<std::complex<double>>& covariance,
                        double noise) const;

  // Sigma, whole, without the noise.
  Eigen::MatrixXcd covariance(std::size_t antennas,
                              const std::vector<std::complex<double>>& covariance) const;

  Eigen::MatrixXcd sigma;  // the lower triangle
  PlaceMean mean;
  double diffuse = 0.0;  // power of what is not traced, share of the traced
};

}  // namespace rayloc
