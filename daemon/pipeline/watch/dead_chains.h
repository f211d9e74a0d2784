// DeadChains: the receive chains that bring nothing any more, by the frames of all transmitters:
// for the heartbeat, the log and the readiness. Locations name them by themselves.
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
  // The frames of one burst. Whether something has changed.
  bool observe(const std::vector<CsiFrame>& frames, const RoomModel& room);
  std::vector<CalibrationWarning> warnings(const RoomModel& room) const;
  void restart() { dead_.clear(); }

 private:
  std::map<std::pair<std::size_t, std::uint8_t>, bool> dead_;  // by access point and core
};

}  // namespace rayloc
