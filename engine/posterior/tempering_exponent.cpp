#include "engine/posterior/tempering_exponent.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/posterior/credible_region.h"

namespace rayloc {
namespace {

// Standard deviation of dishonesty() for honest regions.
constexpr double kSpreadOfHonest = 0.76;

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// True if the mean of `better` exceeds that of `other` by at most the standard error of the
// difference, point by point.
bool is_within_error(std::span<const double> better, std::span<const double> other) {
  std::vector<double> differences(better.size());
  std::transform(better.begin(), better.end(), other.begin(), differences.begin(), std::minus<>());
  const double mean = mean_of(differences);
  double squares = 0.0;
  for (const double difference : differences) {
    squares += (difference - mean) * (difference - mean);
  }
  const auto n = static_cast<double>(differences.size());
  return mean <= std::sqrt(squares / (n * (n - 1.0)));
}

// The estimate with its variances increased.
LocationEstimate widened(LocationEstimate estimate, double more) {
  const auto widen = [&](std::array<double, 9>& covariance) {
    covariance[0] += more;
    covariance[4] += more;
  };
  widen(estimate.covariance);
  for (Hypothesis& hypothesis : estimate.hypotheses) {
    widen(hypothesis.covariance);
  }
  return estimate;
}

double dishonesty(std::vector<double> reaching) {
  std::sort(reaching.begin(), reaching.end());
  const auto n = static_cast<double>(reaching.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < reaching.size(); ++i) {
    sum += (2.0 * static_cast<double>(i) + 1.0) *
           std::log(reaching[i] * (1.0 - reaching[reaching.size() - 1 - i]));
  }
  return -n - sum / n;
}

}  // namespace

TemperingExponent evaluate_exponent(double exponent,
                                    std::span<const LocationEstimate> estimates,
                                    double stated_sigma,
                                    const KnownPlaces& known,
                                    std::span<const double> sigma_floors) {
  RAYLOC_CHECK(!estimates.empty() && estimates.size() == known.places.size());
  RAYLOC_CHECK(!sigma_floors.empty());
  const auto with = [&](std::size_t point, double sigma) {
    return widened(
        estimates[point],
        sigma * sigma - stated_sigma * stated_sigma + known.place_sigma * known.place_sigma);
  };
  TemperingExponent best;
  for (const double sigma : sigma_floors) {
    std::vector<double> scores;
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      scores.push_back(std::log(stated_density(with(i, sigma), known.places[i], known.area)));
    }
    const double score = mean_of(scores);
    if (best.scores.empty() || score > best.score) {
      best = {exponent, sigma, std::move(scores), score, 0.0};
    }
  }
  // A probability, chosen: largest region considered.
  constexpr double kWidestRegion = 0.999;
  std::vector<double> reaching;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const auto one = region_reaching(with(i, best.sigma_floor), known.places[i]);
    reaching.push_back(std::clamp(one.value_or(kWidestRegion), 1.0 - kWidestRegion, kWidestRegion));
  }
  best.dishonesty = dishonesty(std::move(reaching));
  return best;
}

std::size_t best_exponent(std::span<const TemperingExponent> evaluated) {
  RAYLOC_CHECK(!evaluated.empty());
  const auto top = std::max_element(evaluated.begin(),
                                    evaluated.end(),
                                    [](const auto& a, const auto& b) { return a.score < b.score; });
  std::vector<std::size_t> as_good;
  double least = top->dishonesty;
  for (std::size_t i = 0; i < evaluated.size(); ++i) {
    if (is_within_error(top->scores, evaluated[i].scores)) {
      as_good.push_back(i);
      least = std::min(least, evaluated[i].dishonesty);
    }
  }
  auto best = static_cast<std::size_t>(top - evaluated.begin());
  for (const std::size_t i : as_good) {
    best = evaluated[i].dishonesty <= least + kSpreadOfHonest ? i : best;
  }
  return best;
}

}  // namespace rayloc
