// PointResult: comparison of one point of the truth with its matched estimate.
#pragma once

#include <limits>
#include <optional>

#include "daemon/lab/evaluate/truth.h"
#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct PointResult {
  static constexpr double kMissed = std::numeric_limits<double>::infinity();

  double error = kMissed;  // [m], horizontal
  // The estimate has a position and states its uncertainty; otherwise the next three are unused.
  bool is_uncertainty_stated = false;
  double best_of_5 = kMissed;  // [m], for the nearest of the five heaviest hypotheses
  double region = kMissed;     // region_reaching(); infinite: no stated region contains the truth
  std::optional<double> normalized;  // normalized_squared_error()
};

// `estimate`: nullptr, or without a position: a miss.
PointResult evaluate_point(const TruthPoint& truth, const LocationEstimate* estimate);

// [m]; heights are ignored.
double horizontal_distance(const Vec3d& a, const Vec3d& b);

}  // namespace rayloc
