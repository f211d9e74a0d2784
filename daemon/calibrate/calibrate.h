// `rayloc calibrate`: from a site and a survey to a calibrated site.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/calibrate/joint/room_unknowns.h"

namespace rayloc::cli {

struct CalibrateArguments {
  std::string site;                     // as surveyed
  std::vector<std::string> captures;    // [AP=]FILE
  std::string points;                   // csv
  std::optional<Duration> time_offset;  // added to the times of the points
  std::string out;                      // folder to create
  std::string method = "joint";         // or "paper", "gains-only"
  double holdout = 0.2;
  std::optional<double> survey_error;  // [m]; nothing: the joint method finds it
  std::uint64_t seed = 1;
  bool compare = false;
  bool resume = false;
  bool force = false;  // into a folder that is not empty, and what is no success
  bool quiet = false;
  bool progress = false;  // lines of it on stderr, for programs
};

enum class CalibrationOutcome : std::uint8_t {
  kExplains,  // a success, as far as the points held out tell
  kFails,     // CalibrationVerdict says why; the site was written with `force` only
};

// Writes `out` as a complete site with report.json and report.html, or, where the calibration is no
// success, the reports alone. An Error when the inputs do not fit together, naming the row or the
// access point. SIGINT and SIGTERM end the fit: `out` then holds the last good state, and the
// process ends by the signal.
Expected<CalibrationOutcome> run_calibration(const CalibrateArguments& arguments);

}  // namespace rayloc::cli
