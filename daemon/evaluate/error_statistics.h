// ErrorStatistics: how far estimates are from the truth, misses included.
//
// The error of a point is the horizontal distance; that of a miss is infinite, so that a miss
// counts in every denominator and pushes every percentile up. Figures that are infinite then say
// that too many points were missed for them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "daemon/evaluate/truth.h"
#include "engine/base/vec3.h"
#include "engine/localize/location_estimate.h"

namespace rayloc {

struct ErrorStatistics {
  std::size_t n = 0;       // points of the truth
  std::size_t missed = 0;  // no estimate, or NO_FIX
  double median_m = 0.0;
  double mean_m = 0.0;  // infinite after one miss, as rmse_m; of the points located:
  double rmse_m = 0.0;
  std::optional<double> located_mean_m;  // absent when none is located
  std::optional<double> located_rmse_m;
  double cep50_m = 0.0;  // radius that holds half of the errors: the median
  double cep90_m = 0.0;
  double cep95_m = 0.0;
  double below_0_5 = 0.0;  // share of n with an error below 0.5 m
  double below_1 = 0.0;
  // Share of n whose truth lies in the stated region of 50 %, 95 % (credible_region.h).
  double coverage_50 = 0.0;
  double coverage_95 = 0.0;
  // Normalised squared error divided by its two dimensions, averaged over the points located with a
  // covariance: 1 where stated covariances are right, above where they are too small.
  std::optional<double> anees;
  double best_of_5_median_m = 0.0;             // of the nearest of the five heaviest hypotheses
  std::optional<double> room_centre_median_m;  // of always answering `room_centre`
  // Bootstrap intervals of 95 %, by name of the figure.
  std::map<std::string, std::array<double, 2>> ci95;
};

struct StatisticsOptions {
  std::optional<Vec3d> room_centre;
  int resamples = 2000;
  std::uint64_t seed = 1;
};

// matches[i] answers for truth[i]; nullptr: none. REQUIRES: same length, not empty.
ErrorStatistics compute_statistics(const std::vector<TruthPoint>& truth,
                                   const std::vector<const LocationEstimate*>& matches,
                                   const StatisticsOptions& options);

// The value below which `probability` of `values` lies, with linear interpolation between order
// statistics (numpy's and R's default); infinite as soon as an infinite value takes part.
// REQUIRES: not empty.
double percentile(std::vector<double> values, double probability);

}  // namespace rayloc
