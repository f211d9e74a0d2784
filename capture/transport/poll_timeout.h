// The timeout for poll(2).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "engine/base/timestamp.h"

namespace rayloc {

// Rounded up: a wait that ends early would spin. Past times give no wait, times too long for poll()
// its maximum.
inline int poll_milliseconds(Duration timeout) {
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  return static_cast<int>(std::clamp<std::int64_t>(ms, 0, std::numeric_limits<int>::max()));
}

}  // namespace rayloc
