// One line on a terminal that says how far a calibration is.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

#include "engine/calibrate/room_calibration.h"

namespace rayloc::cli {

// What is left of work of which a run did the shares from `first` to `progress.share` in `elapsed`
// seconds; nothing while that is too little to tell. What an earlier run did is no measure.
std::optional<double> seconds_left(double elapsed, double first, double share);

// "joint: about 20 s left, 57 points, fit, step 12, loss 0.3121, held-out 0.871", as far as it fits
// into a line of `columns`.
std::string progress_text(const std::string& method,
                          const CalibrationProgress& progress,
                          std::optional<double> left,
                          std::size_t columns);

class CalibrationProgressLine {
 public:
  // Silent where `quiet` or where stderr is no terminal. `for_programs`: "progress SHARE TEXT", a
  // line each, wherever stderr leads.
  explicit CalibrationProgressLine(bool quiet, bool for_programs = false);
  ~CalibrationProgressLine() { clear(); }
  CalibrationProgressLine(const CalibrationProgressLine&) = delete;
  CalibrationProgressLine& operator=(const CalibrationProgressLine&) = delete;

  // A part of the work begins: "joint", or what is done when there is no more to tell.
  void begin(std::string part);
  // How far it is.
  void show(const CalibrationProgress& progress);
  // The same of work that is told in words: `share` of it, 0 to 1.
  void show(double share, const std::string& what);
  // Takes the line away, before other words or none.
  void clear();

 private:
  void print(const std::string& text);

  std::string part_;
  bool for_programs_;
  bool silent_;
  double share_ = 0.0;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::optional<double> first_;  // share where show() began
};

}  // namespace rayloc::cli
