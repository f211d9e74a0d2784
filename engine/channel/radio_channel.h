// RadioChannel: the channel that a radio is tuned to.
#pragma once

#include <compare>
#include <string>

namespace rayloc {

struct RadioChannel {
  double centre_hz = 0.0;  // centre frequency of the whole channel [Hz]
  int bandwidth_mhz = 0;   // [MHz]: 20, 40, 80 or 160
  friend auto operator<=>(const RadioChannel&, const RadioChannel&) = default;
};

// "5190 MHz (40 MHz wide)"
std::string to_string(const RadioChannel& channel);

// True where CSI of one channel may be read as CSI of the other: tone indices count from the
// centre, so centre and width must agree. Centres may differ by less than half the channel raster
// of 5 MHz (IEEE 802.11-2020), for a centre that was measured.
bool is_same_channel(const RadioChannel& a, const RadioChannel& b);

// True where a device that hops can change from one channel to the other without another width:
// both lie in the band of 2.4, of 5 or of 6 GHz, and are equally wide.
bool is_hop(const RadioChannel& a, const RadioChannel& b);

}  // namespace rayloc
