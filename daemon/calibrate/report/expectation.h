// What to expect of a calibrated site, in one sentence, and what would help most.
#pragma once

#include <string>
#include <vector>

#include "daemon/calibrate/report/calibration_report.h"

namespace rayloc {

// "Good: expect 4 cm with 3 access points (median of 28 points held out)." or, worst first,
// "Usable", "Doubtful", and whose access point is doubtful: one that explains much less of what it
// heard than the best one does. Of a calibration that is no success the first reason.
// REQUIRES: at least one method.
std::string expectation(const CalibrationReport& report);

// What to do next, what helps most first; nothing where all is as good as can be told.
std::vector<std::string> advice(const CalibrationReport& report);

}  // namespace rayloc
