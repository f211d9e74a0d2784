#include "capture/assemble/chain_presence.h"

#include <algorithm>
#include <cstddef>

#include "engine/channel/dead_row.h"

namespace rayloc {
ChainPresence::ChainPresence(const std::vector<std::uint8_t>& expected_rx_chains) {
  for (const std::uint8_t rx_chain : expected_rx_chains) {
    without_[rx_chain] = 0;
  }
}

void ChainPresence::mark(CsiFrame& frame, std::map<std::uint8_t, std::uint64_t>& without_rx_chain) {
  bool is_absent = false;
  for (auto& [rx_chain, frames] : without_) {
    if (brings_rx_chain(frame, rx_chain)) {
      frames = 0;
      continue;
    }
    ++without_rx_chain[rx_chain];
    frames = std::min(frames + 1, kFrames);
    is_absent = is_absent || frames == kFrames;
  }
  if (is_absent) {
    frame.flags.push_back(kFlag);
  }
}

}  // namespace rayloc
