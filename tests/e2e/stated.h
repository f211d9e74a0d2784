// Length, number or rate of a test, from the environment: tests/soak/run sets it.
#pragma once

#include <algorithm>
#include <cstdlib>

namespace rayloc::e2e {

inline bool is_stated(const char* variable) { return std::getenv(variable) != nullptr; }

inline int stated(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

// RAYLOC_SLOWER: how many times slower the programs under test, those with sanitizers, are than the
// plain programs. Rates and paces are divided by it, and asserted times multiplied.
inline int slower() { return std::max(1, stated("RAYLOC_SLOWER", 1)); }

}  // namespace rayloc::e2e
