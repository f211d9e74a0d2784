// TrackedMoment: a moment in which a target was received, and how much of it is new.
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"
#include "engine/localize/array_observation.h"

namespace rayloc {

// Least weight of a moment, chosen: with less it is not compared with any place.
inline constexpr double kMinBurstWeight = 0.02;

struct TrackedMoment {
  const RoomObservation& observation;
  std::span<const CsiFrame> frames;
  Duration elapsed{};  // since the last moment of the target
  // TargetChannel::motion_of; empty: no earlier moment to compare, or noise would hide a movement.
  std::optional<double> motion;
  double credit = 0.0;   // share of a snapshot's weight already given to this channel
  bool is_rest = false;  // TargetChannel::Change::is_rest
};

// Share of a snapshot's weight that moments within `elapsed` have together (METHODS B6).
inline double snapshot_share(Duration elapsed, Duration evidence_time) {
  return std::min(1.0, to_seconds(elapsed) / to_seconds(evidence_time));
}

}  // namespace rayloc
