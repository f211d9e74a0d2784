#include "daemon/pipeline/device/calibration_warnings.h"

#include <algorithm>
#include <utility>

namespace rayloc {

bool is_stated(const CalibrationWarning& warning, const std::vector<CalibrationWarning>& all) {
  return std::any_of(all.begin(), all.end(), [&](const CalibrationWarning& one) {
    return one.problem == warning.problem && one.access_point == warning.access_point;
  });
}

void CalibrationWarnings::set(std::vector<CalibrationWarning> monitor,
                              std::vector<CalibrationWarning> learning,
                              std::vector<CalibrationWarning> dead) {
  std::vector<CalibrationWarning> warnings = std::move(monitor);
  for (CalibrationWarning& warning : learning) {
    if (!is_stated(warning, warnings)) {
      warnings.push_back(std::move(warning));
    }
  }
  for (CalibrationWarning& warning : dead) {
    warnings.push_back(std::move(warning));
  }
  const std::lock_guard lock(mutex_);
  warnings_ = std::move(warnings);
}

std::vector<CalibrationWarning> CalibrationWarnings::now() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

void append_texts(const std::vector<CalibrationWarning>& warnings, std::span<Location> locations) {
  for (const CalibrationWarning& warning : warnings) {
    if (warning.problem == CalibrationProblem::kDeadChain) {
      continue;
    }
    for (Location& location : locations) {
      location.estimate.warnings.push_back(warning.text);
    }
  }
}

}  // namespace rayloc
