// Evaluations.
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "daemon/lab/evaluate/comparison.h"
#include "daemon/lab/evaluate/comparison_plots.h"
#include "daemon/lab/evaluate/statistics_json.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/site_copy.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/progress.h"
#include "python/raising.h"

namespace py = pybind11;

namespace rayloc::python {
namespace {

void check(Expected<void>&& done) {
  if (!done) {
    throw Raised{std::move(done.error())};
  }
}

// [s] since the Unix epoch.
double seconds_of(Timestamp time) { return to_seconds(time.time_since_epoch()); }

void add(const Vec3d& v, std::vector<double>& out) { out.insert(out.end(), {v.x, v.y, v.z}); }

py::array_t<double> triples(std::vector<double>&& values) {
  const py::ssize_t rows = size_of(values.size() / 3);
  return array_of(std::move(values), {rows, 3});
}

py::array_t<double> line_of(std::vector<double>&& values) {
  const py::ssize_t count = size_of(values.size());
  return array_of(std::move(values), {count});
}

py::array_t<double> errors_of(const std::vector<PointResult>& results,
                              double PointResult::*member) {
  std::vector<double> values;
  values.reserve(results.size());
  for (const PointResult& one : results) {
    values.push_back(one.*member);
  }
  return line_of(std::move(values));
}

// The compared values, one row per point of the truth.
py::dict comparison_arrays(const Comparison& comparison) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> time;
  std::vector<double> truth;
  std::vector<double> position;
  for (std::size_t i = 0; i < comparison.truth.size(); ++i) {
    const TruthPoint& point = comparison.truth[i];
    const LocationEstimate* const match = comparison.matches[i];
    time.push_back(seconds_of(point.begin));
    add(point.position, truth);
    add(match != nullptr && match->position ? *match->position
                                            : Vec3d{kNothing, kNothing, kNothing},
        position);
  }
  py::dict arrays;
  arrays["time"] = line_of(std::move(time));
  arrays["truth"] = triples(std::move(truth));
  arrays["position"] = triples(std::move(position));
  arrays["error"] = errors_of(comparison.results, &PointResult::error);
  arrays["best_of_5"] = errors_of(comparison.results, &PointResult::best_of_5);
  arrays["room_centre_error"] = line_of(std::vector<double>(comparison.controls.room_centre));
  return arrays;
}

// Calibration of the given site; empty if no site was given or it is not calibrated.
std::string calibration_of(const Comparison& comparison) {
  return comparison.site && comparison.site->calibration_file
             ? value_of(load_calibration_file(*comparison.site->calibration_file)).id
             : std::string();
}

// Statistics as JSON, the site's calibration, the seed of the intervals, and arrays. `progress` is
// called with Python's lock before each step and at the end.
py::tuple evaluate(const py::dict& given, const py::function& progress) {
  ComparisonRequest request;
  request.estimates = given["estimates"].cast<std::string>();
  request.truth = given["truth"].cast<std::string>();
  request.is_person = given["person"].cast<bool>();
  request.is_filtered = given["filtered"].cast<bool>();
  request.target = given["target"].cast<std::string>();
  request.time_offset = from_seconds(given["time_offset"].cast<double>());
  request.site = given["site"].cast<std::string>();
  const auto plots = given["plots"].cast<std::string>();
  const bool force = given["force"].cast<bool>();
  std::unique_ptr<const Comparison> comparison;
  std::string statistics;
  std::string calibration;
  {
    const py::gil_scoped_release unlocked;
    const auto report = progress_caller(progress);
    report(0.0, "reading");
    comparison = std::make_unique<const Comparison>(value_of(compare_with_truth(request)));
    report(0.5, "statistics of " + std::to_string(comparison->results.size()) + " points");
    statistics = to_json(compute_statistics(comparison->results, comparison->controls, {})).dump();
    calibration = calibration_of(*comparison);
    if (!plots.empty()) {
      report(0.8, "plots");
      check(prepare_output(plots, force));
      check(write_comparison_plots(plots, *comparison));
    }
    report(1.0, "done");
  }
  return py::make_tuple(
      statistics, calibration, BootstrapOptions{}.seed, comparison_arrays(*comparison));
}

}  // namespace

void bind_evaluation(py::module_& module) {
  module.def("version", [] { return RAYLOC_VERSION; });
  module.def("evaluate", evaluate, py::arg("arguments"), py::arg("progress"));
}

}  // namespace rayloc::python
