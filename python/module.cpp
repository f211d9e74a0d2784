// The module rayloc._engine: the engine for Python. Its contents are documented where they are
// declared; deploy/clients/python/rayloc gives it its public names.
#include "python/bindings.h"

PYBIND11_MODULE(_engine, module) {
  module.doc() =
      "The engine of RayLoc as a native module. Use it by the names of the package rayloc; this "
      "module is private.";
  pybind11::options options;
  options.disable_function_signatures();  // the stubs contain them, with types
  options.disable_enum_members_docstring();
  rayloc::python::bind_errors(module);
  rayloc::python::bind_scene(module);
  rayloc::python::bind_devices(module);
  rayloc::python::bind_diffuse(module);
  rayloc::python::bind_paths(module);
  rayloc::python::bind_tracer(module);
  rayloc::python::bind_radio_map(module);
  rayloc::python::bind_frames(module);
  rayloc::python::bind_localizer(module);
  rayloc::python::bind_calibration(module);
  rayloc::python::bind_evaluation(module);
  rayloc::python::bind_simulation(module);
  rayloc::python::bind_site(module);
}
