#include "engine/posterior/credible_region.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/posterior/horizontal_gaussian.h"

namespace rayloc {
namespace {

struct Component {
  HorizontalGaussian gaussian;
  double weight = 0.0;
};

double density(const std::vector<Component>& mixture, double x, double y) {
  double sum = 0.0;
  for (const Component& component : mixture) {
    sum += component.weight * component.gaussian.density(x, y);
  }
  return sum;
}

// Probability of the region where the mixture is denser than `level`. Each component is represented
// by points of equal probability, on rings.
double mass_above(const std::vector<Component>& mixture, double level) {
  // A count, chosen: with kDirections 2048 points, half a thousandth each.
  constexpr int kRings = 64;
  constexpr int kDirections = 32;  // a count on each ring, chosen: 11 degrees apart
  double mass = 0.0;
  for (const Component& component : mixture) {
    int above = 0;
    for (int ring = 0; ring < kRings; ++ring) {
      const double radius = std::sqrt(-2.0 * std::log1p(-(ring + 0.5) / kRings));
      for (int k = 0; k < kDirections; ++k) {
        // Each ring is rotated against the previous one, so that no points line up.
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

// Empty if the estimate has no position or no valid covariance.
std::vector<Component> mixture_of(const LocationEstimate& estimate) {
  if (!estimate.position) {
    return {};
  }
  std::vector<Component> mixture;
  for (const Hypothesis& hypothesis : estimate.hypotheses) {
    const auto gaussian = HorizontalGaussian::create(hypothesis.position, hypothesis.covariance);
    if (!gaussian) {
      return {};
    }
    mixture.push_back({*gaussian, hypothesis.weight});
  }
  if (mixture.empty()) {
    if (const auto gaussian = HorizontalGaussian::create(*estimate.position, estimate.covariance)) {
      mixture.push_back({*gaussian, 1.0});
    }
  }
  return mixture;
}

}  // namespace

double stated_density(const LocationEstimate& estimate, const Vec3d& truth, double area) {
  return density(mixture_of(estimate), truth.x, truth.y) + estimate.residual_probability / area;
}

std::optional<double> region_reaching(const LocationEstimate& estimate, const Vec3d& truth) {
  const auto mixture = mixture_of(estimate);
  if (mixture.empty()) {
    return std::nullopt;
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
  const auto gaussian = HorizontalGaussian::create(*estimate.position, estimate.covariance);
  if (!gaussian) {
    return std::nullopt;
  }
  return gaussian->squared_distance(truth.x, truth.y);
}

}  // namespace rayloc
