// An empty hall with a square floor as a calibrated room, for how localization grows: with the
// floor's area, with access points along its walls, and with the channel's bandwidth.
#pragma once

#include <cstddef>

#include "engine/room/room_model.h"

namespace rayloc::bench {

struct HallSize {
  double area = 100.0;            // [m^2]
  std::size_t access_points = 1;  // spread evenly along the walls
  int bandwidth_mhz = 40;         // 20, 40, 80 or 160: every second tone of 802.11's 312.5 kHz
};

// [m]
double hall_length(const HallSize& size);

// Walls and floor of concrete, 3 m high; two reflections. Chain gains are those that
// test::frames_of() applies.
RoomModel hall_room(const HallSize& size);

}  // namespace rayloc::bench
