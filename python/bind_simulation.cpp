// Simulations of recordings.
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "daemon/lab/simulate/simulate_recordings.h"
#include "python/bindings.h"
#include "python/progress.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

SimulationOptions simulation_of(const py::dict& given) {
  SimulationOptions options;
  options.points = given["points"].cast<std::string>();
  for (const auto& [access_point, file] : given["out"].cast<py::dict>()) {
    options.outputs.push_back({access_point.cast<std::string>(), file.cast<std::string>()});
  }
  options.impairments = given["impairments"].cast<std::string>();
  options.transmitter = given["transmitter"].cast<std::string>();
  options.channels = given["channels"].cast<std::string>();
  options.transmissions.frames = given["frames"].cast<std::size_t>();
  options.transmissions.survey_error = given["survey_error"].cast<double>();
  options.transmissions.seed = given["seed"].cast<std::uint64_t>();
  options.handling = {given["height_sigma"].cast<double>(),
                      given["tilt_deg"].cast<double>(),
                      given["power_sigma_db"].cast<double>()};
  options.second_day = given["second_day"].cast<std::string>();
  options.truth = given["truth"].cast<std::string>();
  options.trace.max_depth = given["depth"].cast<int>();
  options.trace.transmission = given["transmission"].cast<bool>();
  options.trace.diffuse = given["diffuse"].cast<bool>();
  options.model_error = given["model_error"].cast<bool>();
  options.person = given["person"].cast<bool>();
  options.force = given["force"].cast<bool>();
  return options;
}

// The truth as JSON, and the notes. `progress` is called with Python's lock after each point. An
// exception that it raises ends the simulation, and so does Ctrl-C.
py::tuple simulate(const py::dict& given, const py::function& progress) {
  const SimulationOptions options = simulation_of(given);
  const auto folder = given["site"].cast<std::string>();
  std::vector<std::string> notes;
  SimulationObserver observer;
  observer.on_progress = progress_caller(progress);
  observer.on_note = [&notes](const std::string& note) { notes.push_back(note); };
  observer.on_scene_note = [&notes](const SceneNote& note) { notes.push_back(to_line(note)); };
  std::string truth;
  {
    const py::gil_scoped_release unlocked;
    const Site site = value_of(load_site(folder));
    truth = simulation_json(value_of(simulate_recordings(site, options, observer)));
  }
  return py::make_tuple(truth, notes);
}

}  // namespace

void bind_simulation(py::module_& module) {
  module.def("simulate", simulate, py::arg("arguments"), py::arg("progress"));
}

}  // namespace rayloc::python
