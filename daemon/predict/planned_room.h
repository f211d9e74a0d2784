// planned_room: the room of a site as it would be once its access points hang and are calibrated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlannedRoomOptions {
  std::vector<std::string> access_points = {};  // ids; empty: all of the site
  int bandwidth_mhz = 0;                        // 0: that of the site
  std::optional<double> spacing =
      std::nullopt;  // [m], of neighbouring antennas; nothing: as stated
};

// An access point that is calibrated keeps its errors, and its gains where the tones stay. One that
// is not gets chains without gains, and the errors that calibrations leave (planned_room.cpp).
// Errors: as load_room_model(); an id that the site has not or that is named twice, and a spacing
// of antennas that are no row (kUsage).
Expected<RoomModel> planned_room(const Site& site, const PlannedRoomOptions& plan);

// The antennas of a row at other distances: `gaps` [m] between neighbours, about the middle of the
// row. An array of another number of antennas, or one that is no row, stays as it is.
void set_gaps(AntennaArray& array, const std::vector<double>& gaps);

// Distances of neighbours [m]; empty where the antennas are no row.
std::vector<double> gaps_of(const AntennaArray& array);

}  // namespace rayloc
