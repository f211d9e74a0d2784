#include "daemon/pipeline/watch/dead_chains.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "capture/assemble/chain_presence.h"
#include "engine/channel/dead_row.h"

namespace rayloc {
bool DeadChains::observe(const std::vector<CsiFrame>& frames, const RoomModel& room) {
  bool changes = false;
  for (const CsiFrame& frame : frames) {
    const std::size_t access_point = frame.access_point;
    if (access_point >= room.access_points.size()) {
      continue;
    }
    const bool is_flagged =
        std::find(frame.flags.begin(), frame.flags.end(), ChainPresence::kFlag) !=
        frame.flags.end();
    for (const std::uint8_t rx_chain : room.access_points[access_point].rx_chains) {
      bool& dead = dead_[{access_point, rx_chain}];
      const bool now = !brings_rx_chain(frame, rx_chain) && (dead || is_flagged);
      changes = changes || dead != now;
      dead = now;
    }
  }
  return changes;
}

std::vector<CalibrationWarning> DeadChains::warnings(const RoomModel& room) const {
  std::vector<CalibrationWarning> all;
  for (const auto& [chain, dead] : dead_) {
    if (dead) {
      CalibrationWarning& warning = all.emplace_back();
      warning.problem = CalibrationProblem::kDeadChain;
      warning.access_point = chain.first;
      warning.rx_chain = chain.second;
      warning.text = "dead_chain: access point " + room.access_points[chain.first].id +
                     ": no frame has core " + std::to_string(chain.second) +
                     " any more, or it holds nothing; check its antenna and pigtail; the other "
                     "chains are used";
    }
  }
  return all;
}

}  // namespace rayloc
