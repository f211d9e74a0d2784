// planned_room: the room of a site as expected once its access points are mounted and calibrated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlannedRoomOptions {
  std::vector<std::string> access_points = {};   // ids; empty: all of the site
  int bandwidth_mhz = 0;                         // 0: as in the site
  std::optional<double> spacing = std::nullopt;  // [m], of neighbouring antennas; empty: as stated
};

// A calibrated access point keeps its errors, and its gains if the tones are unchanged. Any other
// gets chains without gains, and the usual residual errors of calibrations (planned_room.cpp).
// Errors: as in load_room_model(); an id that the site does not have or that is named twice, and a
// spacing for antennas that are not in a row (kUsage).
Expected<RoomModel> planned_room(const Site& site, const PlannedRoomOptions& plan);

// Sets the antennas of a row to other distances: `gaps` [m] between neighbours, centred on the row.
// An array with another number of antennas, or one that is not a row, is unchanged.
void set_gaps(AntennaArray& array, const std::vector<double>& gaps);

// Distances of neighbours [m]; empty if the antennas are not in a row.
std::vector<double> gaps_of(const AntennaArray& array);

}  // namespace rayloc
