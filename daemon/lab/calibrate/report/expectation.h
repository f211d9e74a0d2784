// Expected accuracy of a calibrated site in one sentence, and the most useful improvements.
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/calibrate/report/calibration_report.h"

namespace rayloc {

// "Good: expect 4 cm with 3 access points (median of 28 points held out)."
// or, worst first, "Usable", "Doubtful", and the doubtful access point: one
// that explains much less of its observations than the best one does. For a
// failed calibration, the first reason. REQUIRES: at least one method.
std::string expectation(const CalibrationReport& report);

// Next steps, most useful first; empty if no improvement can be identified.
std::vector<std::string> advice(const CalibrationReport& report);

}  // namespace rayloc
