#include "engine/base/check.h"
#include "engine/base/check_handler.h"
#include "engine/base/parallel.h"
#include "python/bindings.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

const char* kind_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kBadInput:
      return "bad_input";
    case ErrorKind::kUnavailable:
      return "unavailable";
    case ErrorKind::kInternal:
      return "internal";
    case ErrorKind::kConfiguration:
      return "configuration";
  }
  return "internal";
}

// The class lives as long as the interpreter does.
py::handle& error_class() {
  static py::handle the_class;
  return the_class;
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const Raised& raised) {
    // A message may contain bytes of a file or of a name that are not UTF-8; those are replaced, so
    // that the class and the rest of the text reach the caller.
    const std::string& message = raised.error.message;
    const auto text = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(message.data(), static_cast<py::ssize_t>(message.size()), "replace"));
    if (!text) {
      return;  // out of memory; Python has set its error
    }
    py::object error = error_class()(text);
    error.attr("kind") = kind_of(raised.error.kind);
    PyErr_SetObject(error_class().ptr(), error.ptr());
  }
}

// A failed check of the engine becomes an exception: the process belongs to its user.
void raise_check(const std::string& message) {
  throw Raised{Error{ErrorKind::kInternal,
                     message + "; this is a bug in RayLoc: report it with the call that raised it, "
                               "and discard the objects of that call"}};
}

constexpr const char* kErrorDoc =
    R"(An error that input caused, with the text that the command line would print.

Attributes:
    kind: "usage", "bad_input", "unavailable", "internal" or "configuration".

Shapes: none. Units: none. Frame: none.
Errors: this is the one that all functions of the engine raise.
Source: engine/base/expected.h; daemon/INTERFACE.md section 1 has the kinds.)";

}  // namespace

void bind_errors(py::module_& module) {
  PyObject* made = PyErr_NewExceptionWithDoc("rayloc.Error", kErrorDoc, PyExc_ValueError, nullptr);
  if (made == nullptr) {
    throw py::error_already_set();
  }
  error_class() = made;
  module.attr("Error") = py::reinterpret_steal<py::object>(made).inc_ref();
  py::register_local_exception_translator(translate);
  set_check_handler(raise_check);
  // For tests: a check on the threads of the engine that fails unless `holds`.
  module.def("check", [](bool holds) {
    const py::gil_scoped_release unlocked;
    parallel_for(16, 1, [holds](std::size_t /*index*/) { RAYLOC_CHECK(holds); });
  });
}

}  // namespace rayloc::python
