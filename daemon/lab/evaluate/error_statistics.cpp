#include "daemon/lab/evaluate/error_statistics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

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

template <typename Member>
std::vector<double> all(std::span<const PointResult> results, Member member) {
  std::vector<double> values;
  values.reserve(results.size());
  for (const PointResult& result : results) {
    values.push_back(result.*member);
  }
  return values;
}

std::vector<double> located_errors(std::span<const PointResult> results) {
  std::vector<double> errors = all(results, &PointResult::error);
  std::erase_if(errors, [](double error) { return std::isinf(error); });
  return errors;
}

// Absent if no point has one.
std::optional<double> mean_normalized(const std::vector<std::optional<double>>& values) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& value : values) {
    sum += value.value_or(0.0);
    count += value ? 1U : 0U;
  }
  return count == 0 ? std::nullopt : std::optional(0.5 * sum / static_cast<double>(count));
}

// Empty if both are infinite.
std::optional<double> skill(double median, double control) {
  const double value = 1.0 - median / control;
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

using Points = std::vector<std::size_t>;  // drawn with replacement
using Figure = std::function<std::optional<double>(const Points&)>;

// Percentile bootstrap: the figure over points drawn with replacement; the same draws for every
// figure. Empty if no draw has the figure.
std::optional<std::array<double, 2>> bootstrap(std::size_t count,
                                               const Figure& figure,
                                               const BootstrapOptions& options) {
  std::mt19937_64 random(options.seed);
  std::vector<double> figures;
  Points drawn(count);
  for (int i = 0; i < options.resamples; ++i) {
    for (std::size_t first = 0; first < count; first += options.together) {
      const std::size_t group = random() % (count / options.together);
      for (std::size_t k = 0; k < options.together; ++k) {
        drawn[first + k] = group * options.together + k;
      }
    }
    if (const auto value = figure(drawn)) {
      figures.push_back(*value);
    }
  }
  if (figures.empty()) {
    return std::nullopt;
  }
  return std::array{percentile(figures, 0.025), percentile(figures, 0.975)};
}

template <typename T>
std::vector<T> at(const std::vector<T>& values, const Points& points) {
  std::vector<T> chosen;
  chosen.reserve(points.size());
  for (const std::size_t point : points) {
    chosen.push_back(values[point]);
  }
  return chosen;
}

using OfValues = std::function<double(const std::vector<double>&)>;

OfValues percentile_at(double probability) {
  return [probability](const std::vector<double>& v) { return percentile(v, probability); };
}
OfValues share_under(double limit) {
  return [limit](const std::vector<double>& values) { return share_below(values, limit); };
}

// Adds intervals for the figures that are present.
class Intervals {
 public:
  Intervals(const BootstrapOptions& options, std::size_t count, ErrorStatistics& statistics)
      : options_(options), count_(count), statistics_(statistics) {}

  void add(const char* name, const Figure& figure) {
    if (const auto interval = bootstrap(count_, figure, options_)) {
      statistics_.ci95[name] = *interval;
    }
  }
  void add(const char* name, const std::vector<double>& values, const OfValues& figure) {
    add(name, [&](const Points& points) { return std::optional(figure(at(values, points))); });
  }
  void add_skill(const char* name,
                 const std::vector<double>& errors,
                 const std::vector<double>& control) {
    add(name, [&](const Points& points) {
      return skill(percentile(at(errors, points), 0.5), percentile(at(control, points), 0.5));
    });
  }

 private:
  const BootstrapOptions& options_;
  std::size_t count_;
  ErrorStatistics& statistics_;
};

void state_errors(const std::vector<double>& errors,
                  Intervals& intervals,
                  ErrorStatistics& statistics) {
  const auto state = [&](const char* name, double ErrorStatistics::*member, const OfValues& of) {
    statistics.*member = of(errors);
    intervals.add(name, errors, of);
  };
  state("median_m", &ErrorStatistics::median_m, percentile_at(0.5));
  state("mean_m", &ErrorStatistics::mean_m, mean);
  state("rmse_m", &ErrorStatistics::rmse_m, root_mean_square);
  state("cep50_m", &ErrorStatistics::cep50_m, percentile_at(0.5));
  state("cep90_m", &ErrorStatistics::cep90_m, percentile_at(0.9));
  state("cep95_m", &ErrorStatistics::cep95_m, percentile_at(0.95));
  state("below_0_5", &ErrorStatistics::below_0_5, share_under(0.5));
  state("below_1", &ErrorStatistics::below_1, share_under(1.0));
}

void state_located(std::span<const PointResult> results,
                   Intervals& intervals,
                   ErrorStatistics& statistics) {
  const std::vector<double> located = located_errors(results);
  statistics.missed = results.size() - located.size();
  if (located.empty()) {
    return;
  }
  statistics.located_mean_m = mean(located);
  statistics.located_rmse_m = root_mean_square(located);
  const std::vector<double> errors = all(results, &PointResult::error);
  const auto add = [&](const char* name, const OfValues& of) {
    intervals.add(name, [&errors, &of](const Points& points) {
      std::vector<double> drawn = at(errors, points);
      std::erase_if(drawn, [](double error) { return std::isinf(error); });
      return drawn.empty() ? std::nullopt : std::optional(of(drawn));
    });
  };
  add("located_mean_m", mean);
  add("located_rmse_m", root_mean_square);
}

void state_uncertainty(std::span<const PointResult> results,
                       Intervals& intervals,
                       ErrorStatistics& statistics) {
  const bool is_stated = std::any_of(
      results.begin(), results.end(), [](const PointResult& r) { return r.is_uncertainty_stated; });
  if (!is_stated && statistics.missed < results.size()) {
    return;
  }
  const auto state = [&](const char* name,
                         std::optional<double> ErrorStatistics::*member,
                         const std::vector<double>& values,
                         const OfValues& of) {
    statistics.*member = of(values);
    intervals.add(name, values, of);
  };
  const std::vector<double> regions = all(results, &PointResult::region);
  state("coverage_50", &ErrorStatistics::coverage_50, regions, share_under(0.5));
  state("coverage_95", &ErrorStatistics::coverage_95, regions, share_under(0.95));
  state("best_of_5_median_m",
        &ErrorStatistics::best_of_5_median_m,
        all(results, &PointResult::best_of_5),
        percentile_at(0.5));
  std::vector<std::optional<double>> normalized;
  for (const PointResult& result : results) {
    normalized.push_back(result.normalized);
  }
  statistics.anees = mean_normalized(normalized);
  intervals.add("anees",
                [&](const Points& points) { return mean_normalized(at(normalized, points)); });
}

void state_control(const std::vector<double>& errors,
                   const std::vector<double>& control,
                   std::pair<const char*, std::optional<double> ErrorStatistics::*> median,
                   std::pair<const char*, std::optional<double> ErrorStatistics::*> skill_of,
                   std::pair<Intervals*, ErrorStatistics*> to) {
  if (control.empty()) {
    return;
  }
  RAYLOC_CHECK(control.size() == errors.size());
  auto& [intervals, statistics] = to;
  statistics->*median.second = percentile(control, 0.5);
  statistics->*skill_of.second = skill(percentile(errors, 0.5), percentile(control, 0.5));
  intervals->add(median.first, control, percentile_at(0.5));
  intervals->add_skill(skill_of.first, errors, control);
}

}  // namespace

double percentile(std::vector<double> values, double probability) {
  RAYLOC_CHECK(!values.empty());
  double rank = probability * static_cast<double>(values.size() - 1);
  // 0.95 * 20 is 19 but for rounding, which must not include an infinite neighbour.
  if (std::abs(rank - std::round(rank)) < 1e-9) {
    rank = std::round(rank);
  }
  const auto below = static_cast<std::size_t>(rank);
  const auto position = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), position, values.end());
  const double fraction = rank - static_cast<double>(below);
  if (fraction == 0.0 || below + 1 == values.size() || std::isinf(*position)) {
    return *position;
  }
  const double above = *std::min_element(position + 1, values.end());
  return std::isinf(above) ? above : *position + fraction * (above - *position);
}

ErrorStatistics compute_statistics(std::span<const PointResult> results,
                                   const Controls& controls,
                                   const BootstrapOptions& options) {
  RAYLOC_CHECK(!results.empty() && options.together > 0 && results.size() % options.together == 0);
  ErrorStatistics statistics;
  statistics.n = results.size();
  Intervals intervals(options, results.size(), statistics);
  const std::vector<double> errors = all(results, &PointResult::error);
  state_errors(errors, intervals, statistics);
  state_located(results, intervals, statistics);
  state_uncertainty(results, intervals, statistics);
  state_control(errors,
                controls.room_centre,
                {"room_centre_median_m", &ErrorStatistics::room_centre_median_m},
                {"skill_room_centre", &ErrorStatistics::skill_room_centre},
                {&intervals, &statistics});
  state_control(errors,
                controls.fingerprint,
                {"fingerprint_median_m", &ErrorStatistics::fingerprint_median_m},
                {"skill_fingerprint", &ErrorStatistics::skill_fingerprint},
                {&intervals, &statistics});
  return statistics;
}

}  // namespace rayloc
