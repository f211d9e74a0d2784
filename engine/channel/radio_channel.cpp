#include "engine/channel/radio_channel.h"

#include <cmath>

#include "engine/channel/wifi_band.h"

namespace rayloc {

std::string to_string(const RadioChannel& channel) {
  constexpr double kHzPerMHz = 1e6;
  return std::to_string(std::lround(channel.centre_hz / kHzPerMHz)) + " MHz (" +
         std::to_string(channel.bandwidth_mhz) + " MHz wide)";
}

bool is_same_channel(const RadioChannel& a, const RadioChannel& b) {
  constexpr double kHalfRasterHz = 2.5e6;
  return a.bandwidth_mhz == b.bandwidth_mhz && std::abs(a.centre_hz - b.centre_hz) < kHalfRasterHz;
}

bool is_hop(const RadioChannel& a, const RadioChannel& b) {
  return a.bandwidth_mhz == b.bandwidth_mhz && band_of(a.centre_hz) == band_of(b.centre_hz);
}

}  // namespace rayloc
