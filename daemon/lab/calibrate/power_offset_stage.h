// Calibration step after the room fit: received power offsets of the transmitters that the site
// declares as constant in power (constant_power of site.toml).
#pragma once

#include <span>
#include <vector>

#include "daemon/lab/calibrate/access_point_stage.h"
#include "daemon/lab/calibrate/held_out_fixes.h"
#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/site/model/site.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Fits one access point of the calibrated room with its values in `result`. `points`: one
// transmitter each, held-out points included, since only two numbers are fitted. A device with the
// power of too few points gets no offset and is added to `refused`.
std::vector<TransmitterPower> fit_power_offsets(const Site& site,
                                                const RoomModel& room,
                                                const AccessPointResult& result,
                                                std::span<const HeldOutPoint> points,
                                                std::vector<RefusedInput>& refused);

}  // namespace rayloc
