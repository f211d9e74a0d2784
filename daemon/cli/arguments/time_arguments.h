// Arguments for a time or a pace: --burst 0.2s, --speed max.
#pragma once

#include <optional>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::cli {

// "0.2s", "200ms" or plain seconds, from 1ms to 60s.
Expected<Duration> parse_burst_argument(const std::string& text);

// The speed relative to the recording; empty for "max".
Expected<std::optional<double>> parse_speed_argument(const std::string& text);

// The speed relative to the recording, any number above 0; infinite for "max".
Expected<double> parse_pace_argument(const std::string& text);

}  // namespace rayloc::cli
