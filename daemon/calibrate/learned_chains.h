// The receive chains of a calibrated site, learned from whoever transmits in recordings: what
// raylocd does live (ChainLearner), by hand.
#pragma once

#include <string>
#include <vector>

#include "daemon/arguments/capture_argument.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/chains/chain_state.h"
#include "engine/room/room_model.h"

namespace rayloc::cli {

// Devices are at places that nobody knows, fixed transmitters where the site says. All access
// points with a recording are taken to have been off before it. Empty where no device was heard.
// `notes` as of for_each_frame().
Expected<std::vector<ChainState>> learn_chains(const Site& site,
                                               const RoomModel& room,
                                               const std::vector<CaptureArgument>& captures,
                                               std::vector<std::string>& notes);

// Gains of chains that multiply by these factors beside them.
ChainGains multiplied(const ChainGains& gains, const ChainFactors& factors);

}  // namespace rayloc::cli
