// Learns the receive chains of a calibrated site from the
// transmitters in recordings, as raylocd does live (ChainLearner).
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/chains/chain_state.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Devices are at unknown positions, fixed transmitters where the site states. All access points
// with a recording are assumed to have been powered off before it. Empty if no device was received.
// `notes` as in for_each_frame().
Expected<std::vector<ChainState>> learn_chains(const Site& site,
                                               const RoomModel& room,
                                               const std::vector<CaptureArgument>& captures,
                                               std::vector<std::string>& notes);

// Returns the gains of chains that these factors multiply.
ChainGains multiplied(const ChainGains& gains, const ChainFactors& factors);

}  // namespace rayloc
