#include "daemon/evaluate/error_statistics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include "daemon/evaluate/credible_region.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double horizontal_distance(const Vec3d& a, const Vec3d& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double root_mean_square(const std::vector<double>& values) {
  const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double share_below(const std::vector<double>& values, double limit) {
  const auto below =
      std::count_if(values.begin(), values.end(), [&](double v) { return v < limit; });
  return static_cast<double>(below) / static_cast<double>(values.size());
}

double best_of_5(const LocationEstimate& estimate, const Vec3d& truth) {
  constexpr std::size_t kHypotheses = 5;
  double best =
      estimate.hypotheses.empty() ? horizontal_distance(*estimate.position, truth) : kInfinity;
  for (std::size_t i = 0; i < std::min(kHypotheses, estimate.hypotheses.size()); ++i) {
    best = std::min(best, horizontal_distance(estimate.hypotheses[i].position, truth));
  }
  return best;
}

// What one point contributes.
struct PointResult {
  double error = kInfinity;
  double best_of_5 = kInfinity;
  double region = kInfinity;  // region_reaching(); infinite: no stated region holds the truth
  std::optional<double> normalized;
};

PointResult evaluate_point(const TruthPoint& truth, const LocationEstimate* estimate) {
  PointResult result;
  if (estimate == nullptr || !estimate->position) {
    return result;
  }
  result.error = horizontal_distance(*estimate->position, truth.position);
  result.best_of_5 = best_of_5(*estimate, truth.position);
  result.region = region_reaching(*estimate, truth.position).value_or(kInfinity);
  result.normalized = normalized_squared_error(*estimate, truth.position);
  return result;
}

template <typename Member>
std::vector<double> all(const std::vector<PointResult>& results, Member member) {
  std::vector<double> values;
  values.reserve(results.size());
  for (const PointResult& result : results) {
    values.push_back(result.*member);
  }
  return values;
}

using Figure = std::function<double(const std::vector<double>&)>;

// Percentile bootstrap: the figure over points drawn with replacement.
std::array<double, 2> bootstrap(const std::vector<double>& values,
                                const Figure& figure,
                                const StatisticsOptions& options) {
  std::mt19937_64 random(options.seed);
  std::vector<double> figures;
  std::vector<double> drawn(values.size());
  for (int i = 0; i < options.resamples; ++i) {
    for (double& value : drawn) {
      value = values[random() % values.size()];
    }
    figures.push_back(figure(drawn));
  }
  return {percentile(figures, 0.025), percentile(figures, 0.975)};
}

Figure percentile_at(double probability) {
  return
      [probability](const std::vector<double>& values) { return percentile(values, probability); };
}
Figure share_under(double limit) {
  return [limit](const std::vector<double>& values) { return share_below(values, limit); };
}

void add_intervals(const std::vector<PointResult>& results,
                   const StatisticsOptions& options,
                   ErrorStatistics& statistics) {
  const std::vector<double> errors = all(results, &PointResult::error);
  const std::vector<double> regions = all(results, &PointResult::region);
  const auto add = [&](const char* name, const std::vector<double>& values, const Figure& figure) {
    statistics.ci95[name] = bootstrap(values, figure, options);
  };
  add("median_m", errors, percentile_at(0.5));
  add("mean_m", errors, mean);
  add("rmse_m", errors, root_mean_square);
  add("cep50_m", errors, percentile_at(0.5));
  add("cep90_m", errors, percentile_at(0.9));
  add("cep95_m", errors, percentile_at(0.95));
  add("below_0_5", errors, share_under(0.5));
  add("below_1", errors, share_under(1.0));
  add("coverage_50", regions, share_under(0.5));
  add("coverage_95", regions, share_under(0.95));
  add("best_of_5_median_m", all(results, &PointResult::best_of_5), percentile_at(0.5));
}

}  // namespace

double percentile(std::vector<double> values, double probability) {
  RAYLOC_CHECK(!values.empty());
  double rank = probability * static_cast<double>(values.size() - 1);
  // 0.95 * 20 is 19 but for rounding, which must not draw in an infinite neighbour.
  if (std::abs(rank - std::round(rank)) < 1e-9) {
    rank = std::round(rank);
  }
  const auto below = static_cast<std::size_t>(rank);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), at, values.end());
  const double fraction = rank - static_cast<double>(below);
  if (fraction == 0.0 || below + 1 == values.size() || std::isinf(*at)) {
    return *at;
  }
  const double above = *std::min_element(at + 1, values.end());
  return std::isinf(above) ? above : *at + fraction * (above - *at);
}

ErrorStatistics compute_statistics(const std::vector<TruthPoint>& truth,
                                   const std::vector<const LocationEstimate*>& matches,
                                   const StatisticsOptions& options) {
  RAYLOC_CHECK(!truth.empty() && truth.size() == matches.size());
  std::vector<PointResult> results;
  std::vector<double> located;
  std::vector<double> normalized;
  std::vector<double> control;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    results.push_back(evaluate_point(truth[i], matches[i]));
    if (std::isfinite(results.back().error)) {
      located.push_back(results.back().error);
    }
    if (results.back().normalized) {
      normalized.push_back(*results.back().normalized / 2.0);
    }
    if (options.room_centre) {
      control.push_back(horizontal_distance(*options.room_centre, truth[i].position));
    }
  }
  const std::vector<double> errors = all(results, &PointResult::error);
  const std::vector<double> regions = all(results, &PointResult::region);
  ErrorStatistics statistics;
  statistics.n = truth.size();
  statistics.missed = truth.size() - located.size();
  statistics.median_m = percentile(errors, 0.5);
  statistics.mean_m = mean(errors);
  statistics.rmse_m = root_mean_square(errors);
  if (!located.empty()) {
    statistics.located_mean_m = mean(located);
    statistics.located_rmse_m = root_mean_square(located);
  }
  statistics.cep50_m = statistics.median_m;
  statistics.cep90_m = percentile(errors, 0.9);
  statistics.cep95_m = percentile(errors, 0.95);
  statistics.below_0_5 = share_below(errors, 0.5);
  statistics.below_1 = share_below(errors, 1.0);
  statistics.coverage_50 = share_below(regions, 0.5);
  statistics.coverage_95 = share_below(regions, 0.95);
  if (!normalized.empty()) {
    statistics.anees = mean(normalized);
  }
  statistics.best_of_5_median_m = percentile(all(results, &PointResult::best_of_5), 0.5);
  if (options.room_centre) {
    statistics.room_centre_median_m = percentile(control, 0.5);
  }
  add_intervals(results, options, statistics);
  return statistics;
}

}  // namespace rayloc
