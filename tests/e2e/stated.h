// What the environment says of how long, how often or how fast a test is: tests/soak/run sets it.
#pragma once

#include <cstdlib>

namespace rayloc::e2e {

inline bool is_stated(const char* variable) { return std::getenv(variable) != nullptr; }

inline int stated(const char* variable, int otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atoi(text) : otherwise;
}

}  // namespace rayloc::e2e
