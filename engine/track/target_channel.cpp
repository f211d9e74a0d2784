#include "engine/track/target_channel.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayloc {
namespace {

constexpr double kMinChange = 1e-12;  // of the power; a smaller change is rounding

}  // namespace

const TargetChannel::Earlier* TargetChannel::earlier_of(const ArrayObservation& array) const {
  const auto found = std::find_if(remembered_.begin(), remembered_.end(), [&](const Earlier& one) {
    return one.ap == array.ap && one.h.size() == array.h.size();
  });
  return found == remembered_.end() ? nullptr : &*found;
}

std::optional<TargetChannel::Change> TargetChannel::of(const RoomObservation& observation) const {
  double power = 0.0;
  double noise = 0.0;
  double count = 0.0;
  for (const ArrayObservation& now : observation.arrays) {
    if (const Earlier* before = earlier_of(now)) {
      power += 1.0 - aligner_.align(before->h, now.h).correlation;
      // The power outside the delays of a room is noise, and both moments have it.
      noise += 2.0 - before->captured - now.observed.array.captured;
      count += 1.0;
    }
  }
  if (count <= 0.0) {
    return std::nullopt;
  }
  Change change{std::max(power / count, kMinChange),
                limits_.still_change + noise / count,
                count == static_cast<double>(observation.arrays.size())};
  change.shows_motion = change.unmoved < limits_.moved_change;
  change.is_rest = change.shows_motion && change.is_of_all && change.power <= change.unmoved;
  return change;
}

double TargetChannel::motion_of(const Change& change) const {
  return std::clamp(
      std::log(change.power / change.unmoved) / std::log(limits_.walking_ratio), 0.0, 1.0);
}

void TargetChannel::remember(const RoomObservation& observation) {
  for (const ArrayObservation& received : observation.arrays) {
    Earlier now{received.ap, received.h, received.observed.array.captured};
    const auto found =
        std::find_if(remembered_.begin(), remembered_.end(), [&](const Earlier& one) {
          return one.ap == now.ap && one.h.size() == now.h.size();
        });
    if (found == remembered_.end()) {
      remembered_.push_back(std::move(now));
    } else {
      *found = std::move(now);
    }
  }
}

}  // namespace rayloc
