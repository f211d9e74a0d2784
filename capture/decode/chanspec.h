// Broadcom's chanspec: the 16-bit field in which AX-CSI, nexmon and UbiLocate state the channel.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/channel/radio_channel.h"

namespace rayloc {

// WIRE_FORMATS 1.2. Empty if the value is no channel of 2.4 or 5 GHz: some builds of the extractors
// write another value there.
std::optional<RadioChannel> channel_of_chanspec(std::uint16_t chanspec);

}  // namespace rayloc
