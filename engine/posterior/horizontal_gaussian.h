// HorizontalGaussian: a normal distribution of x and y.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/base/vec3.h"

namespace rayloc {

class HorizontalGaussian {
 public:
  // Empty unless the covariance is positive definite.
  static std::optional<HorizontalGaussian> create(const Vec3d& centre,
                                                  const std::array<double, 9>& covariance) {
    const double xx = covariance[0];
    const double xy = 0.5 * (covariance[1] + covariance[3]);
    const double yy = covariance[4];
    const double determinant = xx * yy - xy * xy;
    if (!(xx > 0.0) || !(determinant > 0.0) || !std::isfinite(determinant)) {
      return std::nullopt;
    }
    HorizontalGaussian gaussian;
    gaussian.centre_ = centre;
    gaussian.l11_ = std::sqrt(xx);
    gaussian.l21_ = xy / gaussian.l11_;
    gaussian.l22_ = std::sqrt(determinant / xx);
    return gaussian;
  }

  double squared_distance(double x, double y) const {
    const double u = (x - centre_.x) / l11_;
    const double v = (y - centre_.y - l21_ * u) / l22_;
    return u * u + v * v;
  }
  double density(double x, double y) const {
    return std::exp(-0.5 * squared_distance(x, y)) / (2.0 * std::numbers::pi * l11_ * l22_);
  }
  // Maps the point (u, v) of a standard normal distribution to this distribution.
  std::array<double, 2> point(double u, double v) const {
    return {centre_.x + l11_ * u, centre_.y + l21_ * u + l22_ * v};
  }

 private:
  Vec3d centre_;
  double l11_ = 1.0;  // Cholesky factor [m]
  double l21_ = 0.0;
  double l22_ = 1.0;
};

}  // namespace rayloc
