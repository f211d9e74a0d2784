// mistakes_of_array: how the antennas of an access point really stand, if the site states them as
// people misread them.
#pragma once

#include <string>
#include <vector>

#include "engine/room/room_model.h"

namespace rayloc {

struct ArrayMistake {
  std::string meaning;  // "turned by 180 degrees", "with cores 2 and 3 exchanged"
  std::string remedy;   // "yaw_deg = 143 instead of -37"; what to write in site.toml
  AntennaArray array;   // as it would really be; element i is still that of core i
};

// The access point turned by half a turn, its antennas mirrored, and its cores in every other order
// (up to kAllOrders chains; of more any two of them exchanged). Some may be the same array: a
// centred line of antennas that is turned is one whose outer cores are exchanged. Empty for a
// single antenna.
constexpr std::size_t kAllOrders = 4;
std::vector<ArrayMistake> mistakes_of_array(const RoomAccessPoint& access_point);

// Whether the same rays reach both with the same strength: only the elements stand elsewhere.
bool share_rays(const AntennaArray& a, const AntennaArray& b);

}  // namespace rayloc
