// The progress of a computation that runs without Python's lock, for a Python function.
#pragma once

#include <functional>
#include <string>

#include <pybind11/pybind11.h>

namespace rayloc::python {

// Calls `progress` with Python's lock. An exception that it raises leaves the computation, and so
// does Ctrl-C. To be called on the thread of the caller; `progress` must outlive the result.
inline std::function<void(double, const std::string&)> progress_caller(
    const pybind11::function& progress) {
  return [&progress](double share, const std::string& part) {
    const pybind11::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) {
      throw pybind11::error_already_set();
    }
    progress(share, part);
  };
}

}  // namespace rayloc::python
