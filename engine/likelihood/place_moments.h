// PlaceMoments: accumulates mean and covariance of the measurement at a place over its rays.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "engine/likelihood/place_model.h"

namespace rayloc {

struct PlaceMean {
  Eigen::VectorXcd all;
  Eigen::VectorXcd direct;  // of the line of sight that may be obstructed; size 0: none
};

struct PlaceMoments {
  explicit PlaceMoments(Eigen::Index size)
      : sigma(Eigen::MatrixXcd::Zero(size, size)), mean{Eigen::VectorXcd::Zero(size), {}} {}

  // Adds a matrix times its conjugate transpose; each column is the unknown part of a ray.
  void add(const Eigen::MatrixXcd& unknown) {
    sigma.selfadjointView<Eigen::Lower>().rankUpdate(unknown);
  }

  // Adds the untraced power and factorises: the diffuse power is spread by `covariance` over the
  // delays of each antenna, [q][q]; `noise` is the total.
  PlaceModel factorised(std::size_t antennas,
                        const std::vector<std::complex<double>>& covariance,
                        double noise) const;

  // The full Sigma without the noise.
  Eigen::MatrixXcd covariance(std::size_t antennas,
                              const std::vector<std::complex<double>>& covariance) const;

  Eigen::MatrixXcd sigma;  // lower triangle
  PlaceMean mean;
  double diffuse = 0.0;  // power that is not traced, as a share of the traced power
};

}  // namespace rayloc
