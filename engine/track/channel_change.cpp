#include "engine/track/channel_change.h"

#include <algorithm>
#include <cmath>

namespace rayloc {
namespace {

constexpr double kMinChange = 1e-12;  // of the power; a smaller change is rounding

}  // namespace

std::optional<double> TargetChannel::of(const RoomObservation& observation) const {
  double sum = 0.0;
  double count = 0.0;
  for (const ArrayObservation& now : observation.arrays) {
    for (const Earlier& before : last_) {
      if (now.ap == before.ap && now.h.size() == before.h.size()) {
        sum += 1.0 - aligner_.align(before.h, now.h).correlation;
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? std::optional(std::max(sum / count, kMinChange)) : std::nullopt;
}

double TargetChannel::unmoved(const RoomObservation& observation) const {
  // The power outside the delays of a room is noise, and both bursts have it.
  double noise = 0.0;
  for (const ArrayObservation& received : observation.arrays) {
    noise += 2.0 * (1.0 - received.observed.array.captured) /
             static_cast<double>(observation.arrays.size());
  }
  return limits_.still_change + noise;
}

double TargetChannel::motion_of(double change, const RoomObservation& observation) const {
  return std::clamp(
      std::log(change / unmoved(observation)) / std::log(limits_.walking_ratio), 0.0, 1.0);
}

void TargetChannel::remember(const RoomObservation& observation) {
  last_.clear();
  for (const ArrayObservation& received : observation.arrays) {
    last_.push_back({received.ap, received.h});
  }
}

}  // namespace rayloc
