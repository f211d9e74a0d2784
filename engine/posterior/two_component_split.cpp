#include "engine/posterior/two_component_split.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr int kIterations = 30;      // a count, chosen: of expectation and maximisation
constexpr double kMinGain = 0.1;     // [nat]
constexpr double kMinMass = 1e-4;    // least share of a component in the peak's mass
constexpr double kStartShare = 0.5;  // of the peak's mass, the densest, that initialises the core

double determinant(const HillMass& g) { return g.xx * g.yy - g.xy * g.xy; }

// Mean of the logarithm of a Gaussian's density over a part, up to a constant.
class LogDensity {
 public:
  explicit LogDensity(const HillMass& gaussian)
      : of_(gaussian), inverse_(1.0 / determinant(gaussian)), log_(-std::log(inverse_)) {}

  double operator()(const HillMass& part) const {
    const double dx = part.x - of_.x;
    const double dy = part.y - of_.y;
    const double square = of_.yy * (dx * dx + part.xx) - 2.0 * of_.xy * (dx * dy + part.xy) +
                          of_.xx * (dy * dy + part.yy);
    return -0.5 * (log_ + square * inverse_);
  }

 private:
  const HillMass& of_;
  double inverse_;
  double log_;
};

HillMass weighted_sum(std::span<const HillMass> parts, std::span<const double> share) {
  HillMass sum;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double mass = share[i] * parts[i].mass;
    sum.mass += mass;
    sum.x += mass * parts[i].x;
    sum.y += mass * parts[i].y;
  }
  if (sum.mass <= 0.0) {
    return sum;
  }
  sum.x /= sum.mass;
  sum.y /= sum.mass;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double relative = share[i] * parts[i].mass / sum.mass;
    const double dx = parts[i].x - sum.x;
    const double dy = parts[i].y - sum.y;
    sum.xx += relative * (dx * dx + parts[i].xx);
    sum.xy += relative * (dx * dy + parts[i].xy);
    sum.yy += relative * (dy * dy + parts[i].yy);
  }
  return sum;
}

// 1 for the densest parts that hold kStartShare of the mass.
std::vector<double> densest(std::span<const HillMass> parts, double whole) {
  std::vector<std::size_t> order(parts.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  const auto density = [&](std::size_t i) {
    return parts[i].mass / std::sqrt(determinant(parts[i]));
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return density(a) > density(b);
  });
  std::vector<double> share(parts.size());
  double held = 0.0;
  for (const std::size_t i : order) {
    share[i] = 1.0;
    held += parts[i].mass;
    if (held >= kStartShare * whole) {
      break;
    }
  }
  return share;
}

}  // namespace

HillMass sum_of(std::span<const HillMass> parts) {
  const std::vector<double> all(parts.size(), 1.0);
  const HillMass sum = weighted_sum(parts, all);
  RAYLOC_CHECK(sum.mass > 0.0);
  return sum;
}

std::optional<std::array<HillMass, 2>> two_component_split(std::span<const HillMass> parts) {
  const HillMass whole = sum_of(parts);
  const LogDensity of_whole(whole);
  std::vector<double> share = densest(parts, whole.mass);
  std::vector<double> rest(parts.size());
  std::array<HillMass, 2> components;
  double gain = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::transform(share.begin(), share.end(), rest.begin(), [](double s) { return 1.0 - s; });
    components = {weighted_sum(parts, share), weighted_sum(parts, rest)};
    if (std::min(components[0].mass, components[1].mass) < kMinMass * whole.mass) {
      return std::nullopt;
    }
    const LogDensity of_core(components[0]);
    const LogDensity of_foot(components[1]);
    const double log_core = std::log(components[0].mass / whole.mass);
    const double log_foot = std::log(components[1].mass / whole.mass);
    const bool is_last = iteration + 1 == kIterations;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double core = log_core + of_core(parts[i]);
      const double foot = log_foot + of_foot(parts[i]);
      share[i] = 1.0 / (1.0 + std::exp(foot - core));
      if (is_last) {
        const double top = std::max(core, foot);
        const double both = top + std::log(std::exp(core - top) + std::exp(foot - top));
        gain += parts[i].mass / whole.mass * (both - of_whole(parts[i]));
      }
    }
  }
  if (gain < kMinGain) {
    return std::nullopt;
  }
  if (determinant(components[0]) > determinant(components[1])) {
    std::swap(components[0], components[1]);
  }
  return components;
}

}  // namespace rayloc
