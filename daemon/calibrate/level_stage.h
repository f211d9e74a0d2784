// The step of a calibration after the room is known: the levels of the transmitters of which the
// site says that their power is constant (constant_power of site.toml).
#pragma once

#include <span>
#include <vector>

#include "daemon/calibrate/access_point_stage.h"
#include "daemon/calibrate/held_out_fixes.h"
#include "daemon/calibrate/report/refused_input.h"
#include "daemon/site/site.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Of one access point of the calibrated room, with what `result` says of it. `spots`: each of one
// transmitter; those that were held out too, for a level is two numbers. A device whose level too
// few of them state gets none and stands in `refused`.
std::vector<TransmitterLevel> fit_levels(const Site& site,
                                         const RoomModel& room,
                                         const AccessPointResult& result,
                                         std::span<const HeldOutSpot> spots,
                                         std::vector<RefusedInput>& refused);

}  // namespace rayloc
