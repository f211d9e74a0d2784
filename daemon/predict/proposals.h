// Proposals: what would be better: other distances of antennas, and access points elsewhere.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "daemon/predict/prediction.h"
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

// Of each change of the room, the prediction at these places; the best first: fewest draws that are
// taken to be elsewhere, then the least median. The room as it is is among them.
Expected<std::vector<Proposal>> proposals(const RoomModel& room,
                                          const std::vector<Vec3d>& places,
                                          const PredictionOptions& options,
                                          const ProposalOptions& which);

}  // namespace rayloc
