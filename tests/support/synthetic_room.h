// A small room with access points, and frames as their radios would report them: for tests of the
// steps from frames to a position. Every antenna element is traced separately.
#pragma once

#include <complex>
#include <cstdint>
#include <random>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/room/ray.h"
#include "engine/room/room_model.h"
#include "engine/trace/path_tracer.h"

namespace rayloc::test {

// 3 x 2.4 x 2.5 m of concrete, an access point of three antennas in each of three corners; chain
// gains are those that frames_at() applies, so the room counts as calibrated.
RoomModel make_room();

// The gains of each chain and tone of an access point: different magnitudes, phases and a slope.
ChainGains make_gains(const RoomModel& room, std::size_t access_point);

struct FrameOptions {
  int count = 4;
  double snr_db = 30.0;
  unsigned seed = 1;
};

// [rx_chain][tone] at the antennas of an access point, each traced separately.
std::vector<std::complex<double>> channel_at(const RoomModel& room,
                                             const RoomAccessPoint& access_point,
                                             const Vec3d& position);

// Rays from the room's device at `position` to the array's centre. tracer: of the room.
std::vector<Ray> rays_to(const PathTracer& tracer,
                         const RoomModel& room,
                         const AntennaArray& array,
                         const Vec3d& position);

// Frames that the access points report when their antennas receive `channels` ([rx_chain][tone]
// each; empty: no reception): unknown gain, phase and timing offset per frame, chain gains, noise.
std::vector<CsiFrame> frames_of(const RoomModel& room,
                                const std::vector<std::vector<std::complex<double>>>& channels,
                                const FrameOptions& options = {});

// The same for a device at `position`.
std::vector<CsiFrame> frames_at(const RoomModel& room,
                                const Vec3d& position,
                                const FrameOptions& options = {});

}  // namespace rayloc::test
