#include "engine/baselines/places/weighted_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/base/median.h"
#include "engine/baselines/plan_map.h"

namespace rayloc {
namespace {

constexpr double kMinSurroundings = 0.05;  // [m], chosen: a survey is no finer
constexpr double kMinWeight = 1e-9;        // a share, chosen: negligible in the map
constexpr double kMinResidual = 0.02;      // a probability, chosen
constexpr double kRegion = 0.99;           // a probability: region for the share of missed truths
constexpr double kCoolest = 0.25;          // a ratio, chosen: lowest temperature tried
constexpr double kWarmest = 64.0;          // a ratio, chosen: highest temperature tried
constexpr double kNextTemperature = 1.15;  // a ratio, chosen: step between temperatures
constexpr std::size_t kRings = 12;         // rings of equal probability of a Gaussian, a count
constexpr std::size_t kSpokes = 8;         // directions, a count

double squared_plan_distance(const Vec3d& a, const Vec3d& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

// Points that represent a Gaussian of deviation 1 in plan, all with the same weight.
std::vector<Vec3d> gaussian_points() {
  std::vector<Vec3d> points;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const double beyond = 1.0 - (static_cast<double>(ring) + 0.5) / static_cast<double>(kRings);
    const double radius = std::sqrt(-2.0 * std::log(beyond));
    for (std::size_t spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(spoke) / kSpokes;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.0});
    }
  }
  return points;
}

// The value with the share `share` of the weight below it.
double quantile(std::vector<std::pair<double, double>> value_and_weight, double share) {
  std::sort(value_and_weight.begin(), value_and_weight.end());
  double total = 0.0;
  for (const auto& [value, weight] : value_and_weight) {
    total += weight;
  }
  double sum = 0.0;
  for (const auto& [value, weight] : value_and_weight) {
    sum += weight;
    if (sum >= share * total) {
      return value;
    }
  }
  return value_and_weight.back().first;
}

// Quantile of a value over the possible places of the target, weighted by their probabilities.
template <typename Value>
double quantile_of(const WeightedPlaces& weighted, double share, const Value& value) {
  static const std::vector<Vec3d> kPoints = gaussian_points();  // [m]
  const std::vector<double> weights = weighted.tempered();
  std::vector<std::pair<double, double>> values;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > kMinWeight) {
      for (const Vec3d& off : kPoints) {
        values.emplace_back(value(weighted.places[i] + weighted.sigma * off), weights[i]);
      }
    }
  }
  return quantile(std::move(values), share);
}

bool is_in_region(const HeldOutPlace& held) {
  const double threshold = quantile_of(held.weighted, 1.0 - kRegion, [&](const Vec3d& place) {
    return held.weighted.log_density(place);
  });
  return held.weighted.log_density(held.truth) >= threshold;
}

std::vector<std::size_t> by_weight(const WeightedPlaces& weighted) {
  std::vector<std::size_t> order(weighted.weights.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return weighted.weights[a] > weighted.weights[b];
  });
  return order;
}

}  // namespace

std::vector<double> WeightedPlaces::tempered() const {
  std::vector<double> powers;
  double sum = 0.0;
  for (const double weight : weights) {
    powers.push_back(std::pow(std::max(weight, 0.0), 1.0 / temperature));
    sum += powers.back();
  }
  for (double& power : powers) {
    power /= sum;
  }
  return powers;
}

double WeightedPlaces::log_density(const Vec3d& place) const {
  const std::vector<double> probabilities = tempered();
  const double variance = sigma * sigma;
  double sum = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    sum += probabilities[i] * std::exp(-0.5 * squared_plan_distance(place, places[i]) / variance);
  }
  return std::log(std::max(sum, std::numeric_limits<double>::min()) /
                  (2.0 * std::numbers::pi * variance));
}

Vec3d WeightedPlaces::mean_of_heaviest() const {
  Vec3d mean;
  double sum = 0.0;
  std::size_t counted = 0;
  for (const std::size_t i : by_weight(*this)) {
    if (counted++ == kHeaviestPlaces) {
      break;
    }
    mean = mean + weights[i] * places[i];
    sum += weights[i];
  }
  return (1.0 / sum) * mean;
}

const Vec3d& WeightedPlaces::heaviest() const { return places[by_weight(*this).front()]; }

double surroundings_of(const std::vector<Vec3d>& places) {
  std::vector<double> nearest;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < places.size(); ++j) {
      if (i != j) {
        least = std::min(least, squared_plan_distance(places[i], places[j]));
      }
    }
    nearest.push_back(std::sqrt(least));
  }
  return std::max(kMinSurroundings, 0.5 * median(std::move(nearest)));
}

PlaceCertainty fit_certainty(std::vector<HeldOutPlace> held) {
  PlaceCertainty best;
  double most = -std::numeric_limits<double>::infinity();
  for (double temperature = kCoolest; temperature < kWarmest; temperature *= kNextTemperature) {
    double sum = 0.0;
    for (HeldOutPlace& one : held) {
      one.weighted.temperature = temperature;
      sum += one.weighted.log_density(one.truth);
    }
    if (sum > most) {
      most = sum;
      best.temperature = temperature;
    }
  }
  std::size_t outside = 0;
  for (HeldOutPlace& one : held) {
    one.weighted.temperature = best.temperature;
    outside += is_in_region(one) ? 0U : 1U;
  }
  if (!held.empty()) {
    best.residual =
        std::max(kMinResidual, static_cast<double>(outside) / static_cast<double>(held.size()));
  }
  return best;
}

void summarise_places(const RoomModel& room,
                      const WeightedPlaces& weighted,
                      const PlaceAnswer& answer,
                      LocationEstimate& estimate) {
  PlanMapOptions map;
  map.accuracy_confidence = answer.accuracy_confidence;
  map.outlier = weighted.residual;
  const std::vector<double> weights = weighted.tempered();
  std::vector<std::pair<Vec3d, double>> informative;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > kMinWeight) {
      informative.emplace_back(weighted.places[i], weights[i]);
    }
  }
  const double half_precision = 0.5 / (weighted.sigma * weighted.sigma);
  summarise_plan(
      room,
      map,
      [&](const Vec3d& cell) {
        double sum = std::numeric_limits<double>::min();
        for (const auto& [place, weight] : informative) {
          sum += weight * std::exp(-half_precision * squared_plan_distance(cell, place));
        }
        return std::log(sum);
      },
      estimate);
  Vec3d position = answer.is_heaviest ? weighted.heaviest() : weighted.mean_of_heaviest();
  position.z = room.device.height;
  estimate.position = position;
  estimate.reason.clear();
  const double own = weighted.sigma * weighted.sigma;
  std::array<double, 9> covariance{own, 0.0, 0.0, 0.0, own, 0.0, 0.0, 0.0, own};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double x = weighted.places[i].x - position.x;
    const double y = weighted.places[i].y - position.y;
    covariance[0] += weights[i] * x * x;
    covariance[1] += weights[i] * x * y;
    covariance[4] += weights[i] * y * y;
  }
  covariance[3] = covariance[1];
  estimate.covariance = covariance;
  estimate.accuracy_m = quantile_of(weighted, answer.accuracy_confidence, [&](const Vec3d& place) {
    return std::sqrt(squared_plan_distance(place, position));
  });
}

}  // namespace rayloc
