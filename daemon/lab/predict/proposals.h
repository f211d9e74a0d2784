// Proposals: better arrangements: other antenna spacings, and other access point positions.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/lab/predict/prediction.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct Proposal {
  std::string what;  // "all antennas 2.9 cm apart"
  Prediction prediction;
};

struct ProposalOptions {
  bool spacings = true;
  bool moves = false;  // half a metre along each axis, an eighth of a turn: minutes
};

// The prediction at these places for each change of the room; best first: fewest draws located at
// another place, then the least median. The unchanged room is included.
Expected<std::vector<Proposal>> proposals(const RoomModel& room,
                                          const std::vector<Vec3d>& places,
                                          const PredictionOptions& options,
                                          const ProposalOptions& which);

}  // namespace rayloc
