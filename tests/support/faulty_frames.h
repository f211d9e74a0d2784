// What goes wrong at an access point, done to frames that were right: for tests of what a fix says
// of itself then.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/room_model.h"

namespace rayloc::test {

// A chain without its antenna: noise at -31 dB of the mean power of the others, and the next chain
// coupled in at -28 dB. `core`: its number; frames without it stay.
void kill_chain(std::vector<CsiFrame>& frames,
                int access_point,
                std::uint8_t core,
                std::mt19937& random);

// A chain that came back from a power cycle with another phase [rad].
void turn_chain(std::vector<CsiFrame>& frames, int access_point, std::uint8_t core, double phase);

// Something that lets 3 % of the amplitude of the direct way through, in front of an access point.
// `room`: as calibrated, which says how strong the direct way is; `device`: where it really is.
void cover(std::vector<CsiFrame>& frames,
           int access_point,
           const RoomModel& room,
           const Vec3d& device);

// [core][tone] of a channel that no room of ours has: taps of random phase that decay with 30 ns,
// other ones for every antenna.
std::vector<std::complex<double>> strange_channel(std::size_t cores,
                                                  std::span<const double> offset_hz,
                                                  std::mt19937& random);

}  // namespace rayloc::test
