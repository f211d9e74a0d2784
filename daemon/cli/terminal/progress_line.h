// ProgressLine: one line of standard error with the progress of long work.
//
//   ProgressLine line(quiet);
//   line.begin("train m3");            // "train m3 ..."
//   line.show(0.4, "epoch 12");        // "train m3: about 20 s left, epoch 12"
//   line.clear();                      // before other output
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>

namespace rayloc::cli {

// Estimates the seconds left from a run that did the shares from `first` to `share` in
// `elapsed` seconds; empty while that is too little. Work of an earlier run does not count.
std::optional<double> seconds_left(double elapsed, double first, double share);

// "joint: about 20 s left, 57 points", without the time if `left` is empty.
std::string progress_line_text(const std::string& part,
                               std::optional<double> left,
                               const std::string& what);
// Truncates to the part that fits into a line of `columns` characters beside the cursor.
std::string fitted_line(std::string text, std::size_t columns);

class ProgressLine {
 public:
  // Silent if `quiet` or if stderr is no terminal. `for_programs`: writes "progress SHARE TEXT",
  // one per line, to any kind of stderr.
  explicit ProgressLine(bool quiet, bool for_programs = false);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  // Begins a part of the work, and the measurement of its time.
  void begin(std::string part);
  // Shows the time left of the part and a text: `share` of the part is done, 0 to 1.
  void show(double share, const std::string& what);
  // Shows "STAGE: 40 %", for work without parts and with stages of unequal duration.
  void show_percent(double share, const std::string& stage);
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
