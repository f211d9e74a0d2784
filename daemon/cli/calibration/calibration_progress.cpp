#include "daemon/cli/calibration/calibration_progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {
namespace {

// A longer text would leave a trail: only its last line can be cleared.
std::size_t columns_of_terminal() {
  constexpr std::size_t kUsual = 80;
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : kUsual;
}

std::string shortened(std::string text, std::size_t columns) {
  if (text.size() >= columns) {
    text.resize(columns > 0 ? columns - 1 : 0);
  }
  return text;
}

}  // namespace

std::optional<double> seconds_left(double elapsed, double first, double share) {
  constexpr double kTellable = 0.03;  // share of the work that suffices for an estimate
  const double done = share - first;
  if (!(done > kTellable)) {
    return std::nullopt;
  }
  return elapsed * std::max(0.0, 1.0 - share) / done;
}

std::string progress_text(const std::string& method,
                          const CalibrationProgress& progress,
                          std::optional<double> left,
                          std::size_t columns) {
  return shortened(fmt::format("{}: {}{} points, {}, step {}, loss {:.4g}, held-out {:.3f}",
                               method,
                               left ? fmt::format("about {:.0f} s left, ", *left) : "",
                               progress.points,
                               progress.step.stage,
                               progress.step.iteration,
                               progress.step.loss,
                               progress.step.heldout),
                   columns);
}

CalibrationProgressLine::CalibrationProgressLine(bool quiet, bool for_programs)
    : for_programs_(for_programs && !quiet),
      silent_(quiet || (!for_programs && isatty(STDERR_FILENO) == 0)),
      begin_(std::chrono::steady_clock::now()) {}

void CalibrationProgressLine::begin(std::string part) {
  part_ = std::move(part);
  begin_ = std::chrono::steady_clock::now();
  first_.reset();
  share_ = 0.0;
  print(part_ + " ...");
}

void CalibrationProgressLine::show(const CalibrationProgress& progress) {
  if (silent_) {
    return;
  }
  first_ = first_.value_or(progress.share);
  share_ = progress.share;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  print(progress_text(part_,
                      progress,
                      seconds_left(elapsed.count(), *first_, progress.share),
                      for_programs_ ? std::string::npos : columns_of_terminal()));
}

void CalibrationProgressLine::show(double share, const std::string& what) {
  first_ = first_.value_or(share);
  share_ = share;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  const auto left = seconds_left(elapsed.count(), *first_, share);
  print(part_ + ": " + (left ? fmt::format("about {:.0f} s left, ", *left) : "") + what);
}

void CalibrationProgressLine::print(const std::string& text) {
  if (silent_) {
    return;
  }
  if (for_programs_) {
    std::fprintf(stderr, "progress %.3f %s\n", share_, text.c_str());
    return;
  }
  std::fprintf(stderr, "\r\033[K%s", shortened(text, columns_of_terminal()).c_str());
  std::fflush(stderr);
  shown_ = true;
}

void CalibrationProgressLine::clear() {
  if (shown_) {
    std::fputs("\r\033[K", stderr);
    shown_ = false;
  }
}

}  // namespace rayloc::cli
