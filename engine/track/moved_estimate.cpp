#include "engine/track/moved_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

void move_by(const Vec3d& path, double variance, Vec3d& position, std::array<double, 9>& of) {
  position = position + path;
  of[0] += variance;
  of[4] += variance;
}

}  // namespace

FilteredEstimate moved_estimate(const FilteredEstimate& last,
                                std::span<const CsiFrame> frames,
                                double speed_variance) {
  RAYLOC_CHECK(!frames.empty());
  FilteredEstimate estimate = last;
  LocationEstimate& location = estimate.location;
  const Timestamp first = frames.front().time;
  location.capture_start = first;
  location.capture_end = frames.back().time;
  location.time = first + (location.capture_end - first) / 2;
  location.frames_used = 0;
  location.access_points_used = 0;
  location.antennas_used = 0;
  estimate.transition.reset();
  const double seconds = to_seconds(location.time - last.location.time);
  const Vec3d path = seconds * last.velocity.value_or(Vec3d{});
  const double variance = speed_variance * seconds * seconds;
  for (Hypothesis& one : location.hypotheses) {
    move_by(path, variance, one.position, one.covariance);
  }
  if (location.position) {
    move_by(path, variance, *location.position, location.covariance);
    // The radius of a circular normal distribution that holds this probability.
    const double rest = std::max(1e-9, 1.0 - location.accuracy_confidence);
    location.accuracy_m =
        std::sqrt(location.accuracy_m * location.accuracy_m - 2.0 * std::log(rest) * variance);
  }
  return estimate;
}

}  // namespace rayloc
