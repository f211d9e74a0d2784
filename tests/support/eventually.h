// eventually(): waits for a condition that another thread or process will fulfil.
#pragma once

#include <chrono>
#include <thread>

#include "tests/support/patience.h"

namespace rayloc {

// Calls `condition` every few milliseconds until it holds. False when `patience`, scaled by
// test::patient(), has run out.
template <typename Condition>
bool eventually(std::chrono::seconds patience, Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + test::patient(patience);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return condition();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace rayloc
