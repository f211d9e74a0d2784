// Lists of the radio channels that a device hops over,
// as typed by people: "36", "36-48", "36-64,100-144".
#pragma once

#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

// For --help, without a full stop.
inline constexpr std::string_view kChannelListMeaning =
    "numbers of 20 MHz channels, such as 36, 36-48 or 36-64,100-144; they select every channel of "
    "the site's band and bandwidth that contains one of them: at 40 MHz, 36-48 selects 5190 and "
    "5230 MHz";

// Ascending, without duplicates. An Error names the invalid part of the text, or the part that no
// channel of the site's band and width contains, with the valid ones. `site`: the site's channel.
Expected<std::vector<RadioChannel>> parse_channels(std::string_view text, const RadioChannel& site);

}  // namespace rayloc
