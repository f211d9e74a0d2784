// How long poll(2) is to wait.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "engine/base/timestamp.h"

namespace rayloc {

// Rounded up: a wait that ends early would spin. What is past is no wait, what is too long for
// poll() the longest that it knows.
inline int poll_milliseconds(Duration timeout) {
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  return static_cast<int>(std::clamp<std::int64_t>(ms, 0, std::numeric_limits<int>::max()));
}

}  // namespace rayloc
