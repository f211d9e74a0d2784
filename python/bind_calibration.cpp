// The calibration of a survey, for a separate process (rayloc/calibrating.py).

#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "daemon/cli/calibration/calibration_runs.h"
#include "daemon/lab/calibrate/calibrate.h"
#include "daemon/live/machine/end_with_parent.h"
#include "python/bindings.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

bool calibrate(const py::dict& given) {
  CalibrateArguments arguments;
  arguments.site = given["site"].cast<std::string>();
  arguments.captures = given["captures"].cast<std::vector<std::string>>();
  arguments.points = given["points"].cast<std::string>();
  arguments.out = given["out"].cast<std::string>();
  arguments.method = given["method"].cast<std::string>();
  arguments.holdout = given["holdout"].cast<double>();
  arguments.survey_error = given["survey_error"].cast<std::optional<double>>();
  arguments.seed = given["seed"].cast<std::uint64_t>();
  arguments.resume = given["resume"].cast<bool>();
  arguments.force = given["force"].cast<bool>();
  const bool progress = given["progress"].cast<bool>();
  const py::gil_scoped_release unlocked;
  auto outcome = cli::calibrate_survey(std::move(arguments), {.quiet = true, .progress = progress});
  return value_of(std::move(outcome)) == CalibrationOutcome::kExplains;
}

}  // namespace

void bind_calibration(py::module_& module) {
  module.def("run_calibration",
             calibrate,
             py::arg("arguments"),
             "Calibrates, and returns true if the calibrated room explains the points held out. It "
             "takes over SIGINT and SIGTERM: only for a process of its own. With `progress`, lines "
             "\"progress SHARE TEXT\" on standard error.");
  module.def("end_with_parent",
             &rayloc::end_with_parent,
             py::arg("parent"),
             "From now on this process is killed when the thread that started it ends. False where "
             "its parent is not the process of this number any more.");
}

}  // namespace rayloc::python
