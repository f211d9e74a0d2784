// The file in which a program stores the learned state of receive chains for the next one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/chains/chain_learner.h"
#include "engine/room/room_model.h"

namespace rayloc {

// JSON: by access point, for those whose chains differ from the calibration, the learned state and
// the calibration that it refers to; the evidence of chains that are being learned
// (ChainState::record) where it is set. Reading returns no state without a file, for a file of
// another calibration, and for access points that no longer exist. An Error for a broken file.
Expected<std::vector<ChainState>> read_chain_file(const std::filesystem::path& file,
                                                  const RoomModel& room);
// Writes the file atomically.
Expected<void> write_chain_file(const std::filesystem::path& file,
                                const std::vector<ChainState>& states,
                                const RoomModel& room);

}  // namespace rayloc
