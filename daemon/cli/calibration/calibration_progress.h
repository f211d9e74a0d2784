// One terminal line with the progress of a calibration.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "engine/calibrate/room_calibration.h"

namespace rayloc::cli {

// Estimates the seconds left from a run that did the shares from `first` to `progress.share` in
// `elapsed` seconds; empty while that is too little. Work of an earlier run does not count.
std::optional<double> seconds_left(double elapsed, double first, double share);

// "joint: about 20 s left, 57 points, fit, step 12, loss
// 0.3121, held-out 0.871", cut to a line of `columns`.
std::string progress_text(const std::string& method,
                          const CalibrationProgress& progress,
                          std::optional<double> left,
                          std::size_t columns);

class CalibrationProgressLine {
 public:
  // Silent if `quiet` or if stderr is no terminal. `for_programs`: writes "progress SHARE TEXT",
  // one per line, to any kind of stderr.
  explicit CalibrationProgressLine(bool quiet, bool for_programs = false);
  ~CalibrationProgressLine() { clear(); }
  CalibrationProgressLine(const CalibrationProgressLine&) = delete;
  CalibrationProgressLine& operator=(const CalibrationProgressLine&) = delete;

  // Begins a part of the work: "joint", or a description of work that has no details.
  void begin(std::string part);
  // Shows its progress.
  void show(const CalibrationProgress& progress);
  // The same for work described by a text: `share` of it, 0 to 1.
  void show(double share, const std::string& what);
  // Removes the line, before other output or at the end.
  void clear();

 private:
  void print(const std::string& text);

  std::string part_;
  bool for_programs_;
  bool silent_;
  double share_ = 0.0;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::optional<double> first_;  // share at the first call of show()
};

}  // namespace rayloc::cli
