#include "daemon/cli/calibration_progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace rayloc::cli {

CalibrationProgressLine::CalibrationProgressLine(std::string method, bool quiet)
    : method_(std::move(method)),
      silent_(quiet || isatty(STDERR_FILENO) == 0),
      begin_(std::chrono::steady_clock::now()) {}

CalibrationProgressLine::~CalibrationProgressLine() {
  if (shown_) {
    std::fputs("\r\033[K", stderr);
  }
}

void CalibrationProgressLine::show(const CalibrationProgress& progress) {
  if (silent_) {
    return;
  }
  const double elapsed =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  constexpr double kTellable = 0.03;  // share of the work from which the rest can be guessed
  const bool tellable = progress.share > kTellable;
  std::fprintf(
      stderr,
      "\r\033[K%s: %zu points, %s, iteration %d, loss %.1f, held-out %.3f, %s",
      method_.c_str(),
      progress.points,
      progress.step.stage.c_str(),
      progress.step.iteration,
      progress.step.loss,
      progress.step.heldout,
      tellable
          ? ("about " + std::to_string(static_cast<int>(elapsed * (1.0 / progress.share - 1.0))) +
             " s left")
                .c_str()
          : "");
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace rayloc::cli
