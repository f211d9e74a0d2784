// The parts of the module rayloc._engine; one file declares each to Python.
#pragma once

#include <pybind11/pybind11.h>

namespace rayloc::python {

void bind_errors(pybind11::module_& module);
void bind_scene(pybind11::module_& module);
void bind_devices(pybind11::module_& module);
void bind_diffuse(pybind11::module_& module);
void bind_paths(pybind11::module_& module);
void bind_tracer(pybind11::module_& module);
void bind_radio_map(pybind11::module_& module);
void bind_frames(pybind11::module_& module);
void bind_localizer(pybind11::module_& module);
void bind_calibration(pybind11::module_& module);
void bind_evaluation(pybind11::module_& module);
void bind_site(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);

}  // namespace rayloc::python
