// TrackOptions: how a target is followed (track.h).
#pragma once

#include <chrono>
#include <cstddef>

#include "engine/base/timestamp.h"
#include "engine/track/cloud_filter.h"
#include "engine/track/follow/hand_over_rules.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

struct TrackOptions {
  MotionModel motion;
  // Correlation time of the model error along a walk: the bursts within it together weigh as much
  // as one snapshot, at any rate of frames.
  Duration evidence_time = std::chrono::milliseconds(400);
  // Exponent of the reported regions while only one access point receives the target. Along a walk
  // errors of its model persist for longer than evidence_time, and no other access point
  // contradicts them (engine/studies/2026-11-chains.md).
  double lone_exponent = 0.75;
  // Share of the power that differs between two bursts when the device has moved by a quarter of
  // the wavelength: that of a room with three quarters of the power in the line of sight.
  double moved_change = 0.25;
  // Share of the power that differs between two bursts of a device at rest, beyond their noise:
  // changes of its own radio. From `walking_ratio` times as much on, the device certainly walks:
  // even with nearly all power in the line of sight, steps of a few centimetres change more.
  double still_change = 0.005;
  double walking_ratio = 5.0;
  std::size_t confirming_bursts = 5;
  Duration coast_after = std::chrono::milliseconds(500);  // time without a burst, to coasting
  Duration forget_after = std::chrono::seconds(1);        // the same, from tentative to lost
  Duration lose_after = std::chrono::seconds(5);          // the same, from any state to lost
  // [1/s], rate at which a height becomes uncertain again, by a change to another height.
  double height_change_rate = 0.05;
  double height_speed = 0.1;  // [m/s], vertical speed of a carried device
  // Compares every burst with the whole room and keeps the whole room in the filter: the reference
  // for the restricted search.
  bool is_exhaustive = false;
  // A confirmed track leaves the grid for a cloud of places, where the likelihood can compare
  // single places; ignored with is_exhaustive.
  bool uses_cloud = false;
  CloudOptions cloud;
  HandOverOptions hand_over;
};

}  // namespace rayloc
