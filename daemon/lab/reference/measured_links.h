// Arrays of the fixed links from recorded frames: of the empty room, and with a person at each
// surveyed point.
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/lab/reference/reference_inputs.h"
#include "engine/base/content_hash.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/person/calibrate/person_fit.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Use of the inputs: the hash of every array, and the inputs that were not used.
struct InputLog {
  ContentHash content;
  std::vector<RefusedInput> refused;
};

// The array of each access point of `room` with frames in `frames`, which are of one transmitter.
// `occupied`: a person walks about, and the common part of the frames is used. Errors: an access
// point that is not calibrated (kConfiguration), frames without a usable array, or with a channel
// that changes although the room is empty (kBadInput).
Expected<std::vector<EmptyRoom>> receive_empty_room(const RoomModel& room,
                                                    const std::vector<CsiFrame>& frames,
                                                    bool occupied,
                                                    InputLog& log);

struct MeasuredPoints {
  std::vector<PersonPoint> points;
  std::vector<std::vector<CsiFrame>> frames;  // by point
};

// The arrays that the links of `reference` received at each point; a point without frames is
// logged. `room`: with the gains of the day of the people. REQUIRES: inputs.people has the
// transmitter of the reference.
MeasuredPoints receive_points(const RoomModel& room,
                              const PersonReference& reference,
                              const ReferenceInputs& inputs,
                              InputLog& log);

}  // namespace rayloc
