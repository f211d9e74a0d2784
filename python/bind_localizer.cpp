// Localizer and LocationEstimate.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "daemon/site/model/path_grid_files.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site.h"
#include "engine/grid/grid.h"
#include "engine/localize/localizer.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/frame_table.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

struct LocalizerHandle {
  std::vector<std::string> access_points;
  std::shared_ptr<const Localizer> localizer;
};

LocalizerHandle localizer_of(const std::filesystem::path& folder, bool cache) {
  const py::gil_scoped_release unlocked;
  const Site site = value_of(load_site(folder));
  const auto room = std::make_shared<const RoomModel>(value_of(load_room_model(site)));
  LocalizerOptions options;
  if (const auto directory = cache ? cache_directory() : std::nullopt) {
    PathGridFiles::Options files;
    files.directory = *directory;
    options.path_grids = std::make_shared<PathGridFiles>(std::move(files));
  }
  return {access_point_ids(site),
          std::make_shared<const Localizer>(value_of(Localizer::create(room, options)))};
}

// Frames of one transmitter, in order of time, as the engine requires.
std::vector<CsiFrame> burst_of(const LocalizerHandle& handle, const FrameTable& table) {
  if (table.access_points != handle.access_points) {
    refuse("these frames were not read for this site: read_frames(captures, site=...)");
  }
  if (table.frames.empty()) {
    refuse("there is no frame to locate by");
  }
  std::vector<CsiFrame> frames = table.frames;
  for (const CsiFrame& frame : frames) {
    if (frame.transmitter != frames.front().transmitter) {
      refuse("these frames are of several transmitters, " + to_string(frames.front().transmitter) +
             " and " + to_string(frame.transmitter) + "; choose one: frames.of(transmitter)");
    }
  }
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  return frames;
}

LocationEstimate locate(const LocalizerHandle& handle,
                        const FrameTable& table,
                        std::optional<double> exponent) {
  const std::vector<CsiFrame> frames = burst_of(handle, table);
  if (exponent && !(*exponent > 0.0 && *exponent <= 1.0)) {
    refuse("likelihood_exponent is above 0 and at most 1");
  }
  const py::gil_scoped_release unlocked;
  return exponent ? handle.localizer->locate(frames, *exponent) : handle.localizer->locate(frames);
}

py::array_t<double> log_likelihood(const LocalizerHandle& handle, const FrameTable& table) {
  const std::vector<CsiFrame> frames = burst_of(handle, table);
  const Grid& grid = handle.localizer->grid();
  std::vector<double> map;
  {
    const py::gil_scoped_release unlocked;
    const RoomObservation received = handle.localizer->receive(frames);
    if (received.arrays.empty()) {
      refuse("no calibrated access point received these frames");
    }
    map = handle.localizer->evidence(received).log_likelihood;
  }
  if (map.empty()) {
    refuse("no place explains these frames");
  }
  return array_of(std::move(map), {size_of(grid.count_x), size_of(grid.count_y)});
}

py::array_t<double> cells_of(const LocalizerHandle& handle) {
  const Grid& grid = handle.localizer->grid();
  std::vector<double> centres;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3d centre = grid.centre(i);
    centres.insert(centres.end(), {centre.x, centre.y, centre.z});
  }
  return array_of(std::move(centres), {size_of(grid.count_x), size_of(grid.count_y), 3});
}

py::object vector_or_none(const std::optional<Vec3d>& v) {
  return v ? py::object(array_of(std::vector<double>{v->x, v->y, v->z}, {3})) : py::none();
}

py::array_t<double> matrix_of(const std::array<double, 9>& values) {
  return array_of(std::vector<double>(values.begin(), values.end()), {3, 3});
}

// Position, covariance and weight of each hypothesis.
py::list hypotheses_of(const LocationEstimate& estimate) {
  py::list all;
  for (const Hypothesis& one : estimate.hypotheses) {
    all.append(py::make_tuple(vector_or_none(one.position), matrix_of(one.covariance), one.weight));
  }
  return all;
}

void bind_estimate(py::module_& module) {
  py::class_<LocationEstimate>(
      module, "LocationEstimate", R"(The position of a device, and its uncertainty.

Made by `Localizer.locate`.

Shapes: `position` (3,), `covariance` (3, 3); `hypotheses` a list of (position, covariance, weight).
Units: metres, square metres; probabilities from 0 to 1.
Frame: the world of the site, right-handed, z up.
Errors: none; without a fix `position` is None and `reason` states the reason.
Source: engine/room/location_estimate.h.)")
      .def_property_readonly(
          "position",
          [](const LocationEstimate& one) { return vector_or_none(one.position); },
          "[m], (3,); None without a fix.")
      .def_readonly("reason", &LocationEstimate::reason, "Why there is no fix; else empty.")
      .def_property_readonly(
          "covariance",
          [](const LocationEstimate& one) { return matrix_of(one.covariance); },
          "Covariance of the whole posterior about `position` [m^2], (3, 3).")
      .def_readonly("accuracy",
                    &LocationEstimate::accuracy_m,
                    "Horizontal radius [m] that holds the device with accuracy_confidence.")
      .def_readonly("accuracy_confidence", &LocationEstimate::accuracy_confidence, "Probability.")
      .def_property_readonly("hypotheses", hypotheses_of, "Heaviest first.")
      .def_readonly("residual_probability",
                    &LocationEstimate::residual_probability,
                    "Probability that the device is at none of the hypotheses.")
      .def_readonly(
          "ambiguous", &LocationEstimate::ambiguous, "True if another place is nearly as likely.")
      .def_readonly("warnings", &LocationEstimate::warnings, "Sentences for people.");
}

}  // namespace

void bind_localizer(py::module_& module) {
  bind_estimate(module);
  py::class_<LocalizerHandle>(module, "NativeLocalizer", "Native part of rayloc.Localizer.")
      .def(py::init(&localizer_of), py::arg("site"), py::arg("cache"))
      .def("locate", locate, py::arg("frames"), py::arg("likelihood_exponent"))
      .def("log_likelihood", log_likelihood, py::arg("frames"))
      .def_property_readonly("cells", cells_of)
      .def_readonly("access_points", &LocalizerHandle::access_points);
}

}  // namespace rayloc::python
