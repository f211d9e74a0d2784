#include "engine/channel/radio_channel.h"

#include <cmath>

namespace rayloc {
namespace {

// Upper ends of the bands of 2.4 and 5 GHz [Hz], IEEE 802.11-2020 annex E.
constexpr double kEndOf2GHz = 2.5e9;
constexpr double kEndOf5GHz = 5.925e9;

int band_of(const RadioChannel& channel) {
  return channel.centre_hz < kEndOf2GHz ? 2 : channel.centre_hz < kEndOf5GHz ? 5 : 6;
}

}  // namespace

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
  return a.bandwidth_mhz == b.bandwidth_mhz && band_of(a) == band_of(b);
}

}  // namespace rayloc
