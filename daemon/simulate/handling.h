// Handling: how a device is held that nobody put on a stand: its height, the tilt of its antenna
// and its power, which other devices, hands and pockets change.
//
// At spots each is drawn anew. Along a walk each changes smoothly: a hand takes seconds to rise,
// and what was drawn of it has the same spread over many walks as over many spots.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/simulate/transmissions.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct Handling {
  double height_sigma = 0.0;    // [m], about DeviceModel::height; 0: as the points state it
  double tilt_deg = 0.0;        // of the antenna from upright at most, any angle to it as likely
  double power_sigma_db = 0.0;  // deviation

  bool changes_anything() const {
    return height_sigma > 0.0 || tilt_deg > 0.0 || power_sigma_db > 0.0;
  }
};

// Devices stay as far from floor and ceiling [m].
inline constexpr double kHeightMargin = 0.1;

// Changes where and how the device of each spot is. Heights of spots are those of the normal
// distribution inside of the room and outside of its solid objects; walks turn back at floor and
// ceiling. `is_walk`: the spots are those of one walk. `file` is for messages: an Error names the
// row where no height of the distribution is free.
Expected<void> handle_devices(std::vector<SimulatedSpot>& spots,
                              bool is_walk,
                              const Handling& handling,
                              const RoomModel& room,
                              std::uint64_t seed,
                              const std::string& file);

}  // namespace rayloc
