// Final summary of a calibration on stderr.
#pragma once

#include <cstddef>
#include <span>

#include "daemon/lab/calibrate/report/calibration_report.h"

namespace rayloc::cli {

struct AccessPointUse {
  std::size_t index = 0;
  std::size_t points = 0;  // used points
};

void print_summary(const CalibrationReport& report, std::span<const AccessPointUse> used);

}  // namespace rayloc::cli
