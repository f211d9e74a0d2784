// The simulated world of a condition: test points in a room, and the frames that its access points
// receive from a device there, or from a fixed transmitter while a person is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/lab/evaluate/truth.h"
#include "daemon/lab/experiment/condition.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/room_model.h"
#include "engine/trace/radio_device.h"

namespace rayloc {

struct StudyPoint {
  Vec3d position;                // [m]
  std::vector<CsiFrame> frames;  // from all access points, by (time, access point)
};

// A walking person.
struct StudyWalk {
  std::vector<TruthPoint> truth;  // one instant per 0.1 s
  std::vector<CsiFrame> frames;   // from all access points, by (time, access point)
};

struct StudyLayout {
  // Input of the method: the room as planned, with the true chain gains.
  RoomModel model;
  // By access point, before a power cycle: the model's gains if no action is taken.
  std::vector<ChainGains> first_day_chains;
  std::vector<StudyPoint> test_points;  // empty for walks
  std::vector<StudyWalk> walks;         // of walking people
  std::vector<StudyPoint> survey;       // at separate places
  // For people: the transmitter, at a random place, and its frames in the empty room.
  std::optional<Transmitter> transmitter;
  std::vector<CsiFrame> empty;
};

// The transmitter's address.
inline constexpr MacAddress kStudyTransmitter = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};

// One result per layout. Test points, clutter and radios depend on the seed and the number of the
// layout alone, so conditions of one experiment are compared on the same draws. Errors: as in
// furnish(), a plan or impairments or a day that cannot be read, a room without places of the
// required distance and sight or without space for a walk, a device that would walk.
Expected<std::vector<StudyLayout>> simulate_world(const Condition& condition, std::uint64_t seed);

}  // namespace rayloc
