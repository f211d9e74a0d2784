#include "daemon/lab/evaluate/point_result.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/posterior/credible_region.h"

namespace rayloc {
namespace {

double best_of_5(const LocationEstimate& estimate, const Vec3d& truth) {
  constexpr std::size_t kHypotheses = 5;
  double best = estimate.hypotheses.empty() ? horizontal_distance(*estimate.position, truth)
                                            : PointResult::kMissed;
  for (std::size_t i = 0; i < std::min(kHypotheses, estimate.hypotheses.size()); ++i) {
    best = std::min(best, horizontal_distance(estimate.hypotheses[i].position, truth));
  }
  return best;
}

}  // namespace

double horizontal_distance(const Vec3d& a, const Vec3d& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

PointResult evaluate_point(const TruthPoint& truth, const LocationEstimate* estimate) {
  PointResult result;
  if (estimate == nullptr || !estimate->position) {
    return result;
  }
  result.error = horizontal_distance(*estimate->position, truth.position);
  result.is_uncertainty_stated = estimate->is_uncertainty_stated;
  if (result.is_uncertainty_stated) {
    result.best_of_5 = best_of_5(*estimate, truth.position);
    result.region = region_reaching(*estimate, truth.position).value_or(PointResult::kMissed);
    result.normalized = normalized_squared_error(*estimate, truth.position);
  }
  return result;
}

}  // namespace rayloc
