// mistakes_of_array: alternative placements of an access point's antennas, for sites that contain
// one of the usual misreadings.
#pragma once

#include <string>
#include <vector>

#include "engine/room/room_model.h"

namespace rayloc {

struct ArrayMistake {
  std::string meaning;  // "rotated by 180 degrees", "with cores 2 and 3 exchanged"
  std::string remedy;   // what to write in site.toml: "yaw_deg = 143 instead of -37"
  AntennaArray array;   // the actual array; element i still belongs to core i
};

// The access point rotated by 180 degrees, its antennas mirrored, and its cores in every other
// order (up to kAllOrders chains; with more, any two of them exchanged). Some may be the same
// array: rotating a centred line of antennas equals exchanging its outer cores. Empty for a single
// antenna.
constexpr std::size_t kAllOrders = 4;
std::vector<ArrayMistake> mistakes_of_array(const RoomAccessPoint& access_point);

// True if the same rays reach both with the same strength: only element positions differ.
bool share_rays(const AntennaArray& a, const AntennaArray& b);

}  // namespace rayloc
