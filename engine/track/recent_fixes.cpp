#include "engine/track/recent_fixes.h"

#include <chrono>

namespace rayloc {
namespace {

// [s], chosen: a step or two of a walk.
constexpr Duration kVelocityWindow = std::chrono::seconds(1);

}  // namespace

void RecentFixes::add(Timestamp time, const Vec3d& position) {
  fixes_.push_back({time, position});
  while (fixes_.front().time < time - kVelocityWindow) {
    fixes_.pop_front();
  }
}

std::optional<Vec3d> RecentFixes::velocity() const {
  if (fixes_.empty() || fixes_.back().time - fixes_.front().time < kVelocityWindow / 2) {
    return std::nullopt;
  }
  const Timestamp now = fixes_.back().time;
  double mean_time = 0.0;
  Vec3d mean;
  const double scale = 1.0 / static_cast<double>(fixes_.size());
  for (const Fix& fix : fixes_) {
    mean_time += scale * to_seconds(fix.time - now);
    mean = mean + scale * fix.position;
  }
  double spread = 0.0;
  Vec3d product;
  for (const Fix& fix : fixes_) {
    const double t = to_seconds(fix.time - now) - mean_time;
    spread += t * t;
    product = product + t * (fix.position - mean);
  }
  return (1.0 / spread) * product;
}

}  // namespace rayloc
