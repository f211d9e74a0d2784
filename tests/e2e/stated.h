// What the environment says of how long, how often or how fast a test is: tests/soak/run sets it.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace rayloc::e2e {

inline bool is_stated(const char* variable) { return std::getenv(variable) != nullptr; }

inline int stated(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

// RAYLOC_SLOWER: how many times slower than the plain programs the ones under test are, those with
// sanitizers. Rates and paces are divided by it, and times that are asserted multiplied.
inline int slower() { return std::max(1, stated("RAYLOC_SLOWER", 1)); }

}  // namespace rayloc::e2e
