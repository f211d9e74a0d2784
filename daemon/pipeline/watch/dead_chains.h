// DeadChains: the receive chains without CSI, from the frames of all transmitters: for the
// heartbeat, the log and the readiness. Locations name them independently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "engine/channel/csi_frame.h"
#include "engine/monitor/calibration_monitor.h"
#include "engine/room/room_model.h"

namespace rayloc {

class DeadChains {
 public:
  // Adds the frames of one burst. True if the set of dead chains has changed.
  bool observe(const std::vector<CsiFrame>& frames, const RoomModel& room);
  std::vector<CalibrationWarning> warnings(const RoomModel& room) const;
  void restart() { dead_.clear(); }

 private:
  std::map<std::pair<std::size_t, std::uint8_t>, bool> dead_;  // by access point and chain
};

}  // namespace rayloc
