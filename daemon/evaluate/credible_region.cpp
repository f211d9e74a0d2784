#include "daemon/evaluate/credible_region.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace rayloc {
namespace {

// A horizontal Gaussian.
class Gaussian {
 public:
  // Nothing unless the covariance is positive definite.
  static std::optional<Gaussian> create(const Vec3d& centre,
                                        const std::array<double, 9>& covariance) {
    const double xx = covariance[0];
    const double xy = 0.5 * (covariance[1] + covariance[3]);
    const double yy = covariance[4];
    const double determinant = xx * yy - xy * xy;
    if (!(xx > 0.0) || !(determinant > 0.0) || !std::isfinite(determinant)) {
      return std::nullopt;
    }
    Gaussian gaussian;
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
  // The point that is (u, v) of a standard normal distribution.
  std::array<double, 2> point(double u, double v) const {
    return {centre_.x + l11_ * u, centre_.y + l21_ * u + l22_ * v};
  }

 private:
  Vec3d centre_;
  double l11_ = 1.0;  // Cholesky factor [m]
  double l21_ = 0.0;
  double l22_ = 1.0;
};

struct Component {
  Gaussian gaussian;
  double weight = 0.0;
};

double density(const std::vector<Component>& mixture, double x, double y) {
  double sum = 0.0;
  for (const Component& component : mixture) {
    sum += component.weight * component.gaussian.density(x, y);
  }
  return sum;
}

// Probability of where the mixture is denser than `level`. Each component is represented by points
// of equal probability, on rings.
double mass_above(const std::vector<Component>& mixture, double level) {
  constexpr int kRings = 64;
  constexpr int kDirections = 32;
  double mass = 0.0;
  for (const Component& component : mixture) {
    int above = 0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double radius = std::sqrt(-2.0 * std::log1p(-(ring + 0.5) / kRings));
      for (int k = 0; k < kDirections; ++k) {
        // Each ring is turned against the last, so that the points line up nowhere.
        const double angle = 2.0 * std::numbers::pi * (k + 0.5 * (ring % 2)) / kDirections;
        const auto [x, y] =
            component.gaussian.point(radius * std::cos(angle), radius * std::sin(angle));
        above += density(mixture, x, y) > level ? 1 : 0;
      }
    }
    mass += component.weight * above / (kRings * kDirections);
  }
  return mass;
}

}  // namespace

std::optional<double> region_reaching(const LocationEstimate& estimate, const Vec3d& truth) {
  if (!estimate.position) {
    return std::nullopt;
  }
  std::vector<Component> mixture;
  for (const Hypothesis& hypothesis : estimate.hypotheses) {
    const auto gaussian = Gaussian::create(hypothesis.position, hypothesis.covariance);
    if (!gaussian) {
      return std::nullopt;
    }
    mixture.push_back({*gaussian, hypothesis.weight});
  }
  if (mixture.empty()) {
    const auto gaussian = Gaussian::create(*estimate.position, estimate.covariance);
    if (!gaussian) {
      return std::nullopt;
    }
    mixture.push_back({*gaussian, 1.0});
  }
  if (mixture.size() == 1) {
    const double d2 = mixture.front().gaussian.squared_distance(truth.x, truth.y);
    return mixture.front().weight * -std::expm1(-0.5 * d2);
  }
  return mass_above(mixture, density(mixture, truth.x, truth.y));
}

std::optional<double> normalized_squared_error(const LocationEstimate& estimate,
                                               const Vec3d& truth) {
  if (!estimate.position) {
    return std::nullopt;
  }
  const auto gaussian = Gaussian::create(*estimate.position, estimate.covariance);
  if (!gaussian) {
    return std::nullopt;
  }
  return gaussian->squared_distance(truth.x, truth.y);
}

}  // namespace rayloc
