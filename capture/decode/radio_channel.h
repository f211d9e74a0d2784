// RadioChannel: the channel that a radio says it is tuned to, where a wire format tells.
#pragma once

#include <cstdint>
#include <optional>

namespace rayloc {

struct RadioChannel {
  double centre_hz = 0.0;
  int bandwidth_mhz = 0;
  friend auto operator<=>(const RadioChannel&, const RadioChannel&) = default;
};

// Of Broadcom's chanspec (WIRE_FORMATS 1.2). Nothing where it names no channel of 2.4 or 5 GHz:
// some builds of the extractors write something else there.
std::optional<RadioChannel> channel_of_chanspec(std::uint16_t chanspec);

}  // namespace rayloc
