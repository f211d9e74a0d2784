// The file in which a program keeps what it learned of receive chains for the next one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/chains/chain_learner.h"
#include "engine/room/room_model.h"

namespace rayloc {

// JSON: by access point, of those whose chains are not as calibrated, what is known of them, and of
// which calibration. Reading gives nothing where there is no file, where it is of another
// calibration, and of access points that are no longer there. An Error for a broken file.
Expected<std::vector<ChainState>> read_chain_file(const std::filesystem::path& file,
                                                  const RoomModel& room);
// The file is there whole or not at all.
Expected<void> write_chain_file(const std::filesystem::path& file,
                                const std::vector<ChainState>& states,
                                const RoomModel& room);

}  // namespace rayloc
