// Handling: pose and power of a hand-held device: its height, the tilt of its antenna and its
// power, which other devices, hands and pockets change.
//
// At test points each value is drawn independently. Along a walk each changes smoothly: a hand
// takes seconds to rise, and a value has the same spread over many walks as over many test points.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/lab/simulate/transmissions.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct Handling {
  double height_sigma = 0.0;    // [m], about DeviceModel::height; 0: heights as in the points
  double tilt_deg = 0.0;        // largest antenna angle from upright; angles are equally likely
  double power_sigma_db = 0.0;  // deviation

  bool changes_anything() const {
    return height_sigma > 0.0 || tilt_deg > 0.0 || power_sigma_db > 0.0;
  }
};

// Least distance of devices from floor and ceiling [m].
inline constexpr double kHeightMargin = 0.1;

// Changes the position and pose of the device at each test point. Heights of test points have the
// normal distribution restricted to the room without its solid objects; walks turn back at floor
// and ceiling. `is_walk`: the test points belong to one walk. `file` is used in messages: an Error
// names the row at which no height of the distribution is free.
Expected<void> handle_devices(std::vector<SimulatedPoint>& test_points,
                              bool is_walk,
                              const Handling& handling,
                              const RoomModel& room,
                              std::uint64_t seed,
                              const std::string& file);

}  // namespace rayloc
