// Calibration as a use case: produces a calibrated site from a site and a survey.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/fit_observer.h"
#include "daemon/lab/calibrate/report/calibration_report.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/calibrate/joint/room_unknowns.h"

namespace rayloc {

// How the caller stops a fit. Empty functions: it cannot be stopped.
struct FitControl {
  // Called once, before the fit: from then on a stop writes the last good state.
  std::function<void()> on_begin;
  std::function<bool()> stop_requested;  // polled during the fit

  bool is_stop_requested() const { return stop_requested && stop_requested(); }
};

struct CalibrateArguments {
  std::string site;                     // site as surveyed
  std::vector<std::string> captures;    // [AP=]FILE
  std::string points;                   // csv
  std::optional<Duration> time_offset;  // offset added to the times of the points
  std::string out;                      // output folder, created
  std::string method = "joint";         // or "paper", "gains-only"
  double holdout = 0.2;
  std::optional<double> survey_error;  // [m]; empty: estimated by the joint method
  std::uint64_t seed = 1;
  bool compare = false;
  bool resume = false;
  bool force = false;  // write to a non-empty folder, and write a failed calibration
  FitControl control = {};
};

enum class CalibrationOutcome : std::uint8_t {
  kExplains,  // a success, according to the held-out points
  kFails,     // reasons are in CalibrationVerdict; site written only if `force`
};

struct AccessPointUse {
  std::size_t index = 0;   // into CalibrationReport::access_points
  std::size_t points = 0;  // used points
};

// State of the output after a requested stop.
struct CalibrationInterruption {
  bool is_whole = false;     // the written calibration was not shortened by the stop
  bool resumes = false;      // `resume` continues it
  bool is_compared = false;  // the comparison was completed, or not requested
};

struct CalibrationResult {
  CalibrationOutcome outcome = CalibrationOutcome::kExplains;
  CalibrationReport report;          // as in report.json
  std::vector<AccessPointUse> used;  // empty: the inputs were refused before the fit
  bool is_site_written = true;       // false: `out` has only the reports
  std::optional<CalibrationInterruption> interruption;
};

// Writes `out` as a complete site with report.json and report.html, or only the reports if the
// calibration is no success. Returns an Error that names the row or the access point if the inputs
// do not fit together. A requested stop ends the fit, and `out` then holds the last good state.
// Threads may run calibrations at the same time, each into a folder of its own.
Expected<CalibrationResult> run_calibration(const CalibrateArguments& arguments,
                                            const FitObserver& observer = {});

}  // namespace rayloc
