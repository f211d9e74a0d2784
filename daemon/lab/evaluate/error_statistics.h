// ErrorStatistics: errors of estimates against the truth, misses included.
//
// The error of a point is the horizontal distance; that of a miss is infinite, so that a miss
// counts in every denominator and pushes every percentile up. An infinite figure then indicates
// that too many points were missed for it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/lab/evaluate/point_result.h"

namespace rayloc {

struct ErrorStatistics {
  std::size_t n = 0;       // points of the truth
  std::size_t missed = 0;  // no estimate, or NO_FIX
  double median_m = 0.0;
  double mean_m = 0.0;  // infinite after one miss, as rmse_m; over the points located:
  double rmse_m = 0.0;
  std::optional<double> located_mean_m;  // absent if none is located
  std::optional<double> located_rmse_m;
  double cep50_m = 0.0;  // radius that contains half of the errors: the median
  double cep90_m = 0.0;
  double cep95_m = 0.0;
  double below_0_5 = 0.0;  // share of n with an error below 0.5 m
  double below_1 = 0.0;

  // The next four are absent if points are located and no estimate states an uncertainty. If some
  // do, an estimate without one counts as an empty region.
  //
  // Share of n with the truth in the stated region of 50 %, 95 % (credible_region.h).
  std::optional<double> coverage_50;
  std::optional<double> coverage_95;
  // Normalised squared error divided by its two dimensions, averaged over the points located with a
  // covariance: 1 if stated covariances are right, above 1 if they are too small.
  std::optional<double> anees;
  std::optional<double> best_of_5_median_m;  // for the nearest of the five heaviest hypotheses

  // Controls: baselines that use nothing, or only the survey.
  std::optional<double> room_centre_median_m;  // always answers the room's centre
  std::optional<double> fingerprint_median_m;  // always answers the most similar surveyed point
  // 1 - median_m / that of the control: 1 without error, 0 if the control is as good.
  std::optional<double> skill_room_centre;
  std::optional<double> skill_fingerprint;

  // Bootstrap intervals of 95 %, by name of the figure. A
  // skill's interval uses both medians on the same draws.
  std::map<std::string, std::array<double, 2>> ci95;
};

// The errors of a control, one per point of the truth [m],
// infinite without an answer; empty: no such control.
struct Controls {
  std::vector<double> room_centre;
  std::vector<double> fingerprint;
};

struct BootstrapOptions {
  int resamples = 2000;
  std::uint64_t seed = 1;
  // Number of successive dependent points, such as one test point
  // located several times: they are resampled together.
  std::size_t together = 1;
};

// REQUIRES: results not empty, a multiple of options.together;
// a control has as many errors as there are results.
ErrorStatistics compute_statistics(std::span<const PointResult> results,
                                   const Controls& controls,
                                   const BootstrapOptions& options);

// The value below which `probability` of `values` lies, with linear
// interpolation between order statistics (numpy's and R's default);
// infinite as soon as an infinite value is used. REQUIRES: not empty.
double percentile(std::vector<double> values, double probability);

}  // namespace rayloc
