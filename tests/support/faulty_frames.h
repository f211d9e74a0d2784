// Applies faults of an access point to correct frames, for tests of the warnings and uncertainty
// that a fix then reports.
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

// Removes the antenna of a chain: noise at -31 dB of the mean power of the others, and the next
// chain coupled in at -28 dB. `core`: number of the chain; frames without it are unchanged.
void kill_chain(std::vector<CsiFrame>& frames,
                std::size_t access_point,
                std::uint8_t rx_chain,
                std::mt19937& random);

// Adds a phase [rad] to one chain, as after a power cycle.
void turn_chain(std::vector<CsiFrame>& frames,
                std::size_t access_point,
                std::uint8_t rx_chain,
                double phase);

// Places an obstruction that passes 3 % of the direct path's amplitude in front of an access point.
// `room`: as calibrated, gives the direct path's strength; `device`: the true position.
void obstruct(std::vector<CsiFrame>& frames,
              std::size_t access_point,
              const RoomModel& room,
              const Vec3d& device);

// [rx_chain][tone] of a channel that no test room produces: taps of random phase that decay with 30
// ns, independent for every antenna.
std::vector<std::complex<double>> strange_channel(std::size_t rx_chains,
                                                  std::span<const double> offset_hz,
                                                  std::mt19937& random);

}  // namespace rayloc::test
