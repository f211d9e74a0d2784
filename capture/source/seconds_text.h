// Durations in messages about a recording.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "engine/base/timestamp.h"

namespace rayloc {

// "1.5 s".
inline std::string seconds_text(Duration duration) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.1f s", to_seconds(duration));
  return text.data();
}

}  // namespace rayloc
