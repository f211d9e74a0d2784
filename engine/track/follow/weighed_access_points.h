// WeighedAccessPoints: the times at which a target's position was last compared with the moments of
// each access point.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/localize/array_observation.h"
#include "engine/track/searched_cells.h"

namespace rayloc {

class WeighedAccessPoints {
 public:
  void note(const RoomObservation& observation, Timestamp time) {
    for (const ArrayObservation& received : observation.arrays) {
      times_.resize(std::max(times_.size(), received.ap + 1));
      times_[received.ap] = time;
    }
  }

  // Number of access points within kRecent of the latest moment.
  std::size_t recent() const {
    const auto latest = std::max_element(times_.begin(), times_.end());
    return static_cast<std::size_t>(
        std::count_if(times_.begin(), times_.end(), [&](const auto& time) {
          return time && *time + kRecent >= **latest;
        }));
  }

  // True if one of its access points was absent or suspect in every moment of the last seconds: it
  // may separate places that all others find alike.
  bool is_joined_by(const RoomObservation& observation, Timestamp time) const {
    return std::any_of(observation.arrays.begin(),
                       observation.arrays.end(),
                       [&](const ArrayObservation& received) {
                         return received.ap >= times_.size() || !times_[received.ap] ||
                                time - *times_[received.ap] > kWholeRoomPeriod;
                       });
  }

 private:
  // Chosen: a walk keeps its direction for about this long (MotionModel), so older evidence no
  // longer constrains the position.
  static constexpr Duration kRecent = std::chrono::seconds(1);

  std::vector<std::optional<Timestamp>> times_;  // [ArrayObservation::ap]
};

}  // namespace rayloc
