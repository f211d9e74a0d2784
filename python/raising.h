// Raises an engine Error as the Python exception rayloc.Error, with the same text.
#pragma once

#include <string>
#include <utility>

#include "engine/base/expected.h"

namespace rayloc::python {

// The exception that bind_errors() translates; it never reaches Python.
struct Raised {
  Error error;
};

// Returns the value, or throws. Callable with Python's lock or without it.
template <typename T>
T value_of(Expected<T>&& expected) {
  if (!expected) {
    throw Raised{std::move(expected.error())};
  }
  return *std::move(expected);
}

[[noreturn]] inline void refuse(std::string message) {
  throw Raised{Error{ErrorKind::kUsage, std::move(message)}};
}

}  // namespace rayloc::python
