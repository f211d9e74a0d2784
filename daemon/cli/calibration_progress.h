// One line on a terminal that says how far a calibration is.
#pragma once

#include <chrono>
#include <string>

#include "engine/calibrate/room_calibration.h"

namespace rayloc::cli {

class CalibrationProgressLine {
 public:
  // Silent where `quiet` or where stderr is no terminal.
  CalibrationProgressLine(std::string method, bool quiet);
  ~CalibrationProgressLine();
  CalibrationProgressLine(const CalibrationProgressLine&) = delete;
  CalibrationProgressLine& operator=(const CalibrationProgressLine&) = delete;

  void show(const CalibrationProgress& progress);

 private:
  std::string method_;
  bool silent_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace rayloc::cli
