// Errors of ours as the Python exception rayloc.Error, with the same text.
#pragma once

#include <string>
#include <utility>

#include "engine/base/expected.h"

namespace rayloc::python {

// What bind_errors() translates; never seen by Python.
struct Raised {
  Error error;
};

// The value, or the exception. With the lock of Python or without it.
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
