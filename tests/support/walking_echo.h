// frames_past(): the CSI of a fixed transmitter in free space while its echo comes from a moving
// point, for tests of methods that follow people. The physics is implemented here and shares
// nothing with the tracer: a direct path, and one echo of length |transmitter - point| + |point -
// antenna|.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc::test {

struct WalkingEcho {
  MacAddress mac;
  Vec3d transmitter;  // [m]
  double echo = 0.5;  // amplitude relative to the direct path, at equal length
  double snr_db = 40.0;
  // Amplitude of the direct path at an antenna on a tone of the grid.
  std::function<double(std::size_t antenna, std::size_t tone)> direct =
      [](std::size_t, std::size_t) { return 1.0; };
};

// Frames of all access points of the room, every `step` [s] from the epoch on, for `seconds`.
std::vector<CsiFrame> frames_past(const RoomModel& room,
                                  const WalkingEcho& link,
                                  double seconds,
                                  double step,
                                  const std::function<Vec3d(double seconds)>& place);

}  // namespace rayloc::test
