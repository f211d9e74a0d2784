#include "capture/assemble/chain_presence.h"

#include <algorithm>
#include <cstddef>

#include "engine/channel/dead_row.h"

namespace rayloc {
ChainPresence::ChainPresence(const std::vector<std::uint8_t>& expected_cores) {
  for (const std::uint8_t core : expected_cores) {
    without_[core] = 0;
  }
}

void ChainPresence::mark(CsiFrame& frame, std::map<std::uint8_t, std::uint64_t>& without_core) {
  bool is_absent = false;
  for (auto& [core, frames] : without_) {
    if (brings_core(frame, core)) {
      frames = 0;
      continue;
    }
    ++without_core[core];
    frames = std::min(frames + 1, kFrames);
    is_absent = is_absent || frames == kFrames;
  }
  if (is_absent) {
    frame.flags.push_back(kFlag);
  }
}

}  // namespace rayloc
