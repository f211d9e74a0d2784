// The simulated world of a condition: spots in a room, and what its access points hear of a device
// there, or of a fixed transmitter while a person stands there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/evaluate/truth.h"
#include "daemon/experiment/condition.h"
#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/observe/chain_gains.h"
#include "engine/room/room_model.h"
#include "engine/trace/radio_device.h"

namespace rayloc {

struct StudySpot {
  Vec3d position;                // [m]
  std::vector<CsiFrame> frames;  // of all access points, by (time, access point)
};

// Somebody who walks.
struct StudyWalk {
  std::vector<TruthPoint> truth;  // an instant each 0.1 s
  std::vector<CsiFrame> frames;   // of all access points, by (time, access point)
};

struct StudyLayout {
  // What the method is told: the room as planned, with the chain gains as they are.
  RoomModel model;
  // Of each access point, before a power cycle: what the model believes when nobody acts.
  std::vector<ChainGains> first_day_chains;
  std::vector<StudySpot> spots;   // none where people walk
  std::vector<StudyWalk> walks;   // of people who walk
  std::vector<StudySpot> survey;  // at places of their own
  // Of people: who sends, at a random place, and what is heard of it while nobody is in the room.
  std::optional<Transmitter> transmitter;
  std::vector<CsiFrame> empty;
};

// Its address.
inline constexpr MacAddress kStudyTransmitter = {{0x02, 0x52, 0x4c, 0x00, 0x00, 0x01}};

// One a layout. Spots, clutter and radios depend on the seed and the number of the layout alone, so
// conditions of one experiment are compared on the same draws. Errors: as of furnish(), a plan or
// impairments or a day that cannot be read, a room without places of the wanted distance and sight
// or without a way to walk, a device that would walk.
Expected<std::vector<StudyLayout>> simulate_world(const Condition& condition, std::uint64_t seed);

}  // namespace rayloc
