// RAYLOC_CHECK(condition): stops the program when an internal assumption is violated.
//
// It is not for input: invalid input is an Error (expected.h).
#pragma once

namespace rayloc {

[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace rayloc

#define RAYLOC_CHECK(condition)                               \
  do {                                                        \
    if (!(condition)) {                                       \
      ::rayloc::check_failed(#condition, __FILE__, __LINE__); \
    }                                                         \
  } while (false)
