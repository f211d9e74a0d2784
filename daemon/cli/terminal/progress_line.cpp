#include "daemon/cli/terminal/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
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

}  // namespace

std::optional<double> seconds_left(double elapsed, double first, double share) {
  constexpr double kTellable = 0.03;  // share of the work that suffices for an estimate
  const double done = share - first;
  if (!(done > kTellable)) {
    return std::nullopt;
  }
  return elapsed * std::max(0.0, 1.0 - share) / done;
}

std::string progress_line_text(const std::string& part,
                               std::optional<double> left,
                               const std::string& what) {
  return part + ": " + (left ? fmt::format("about {:.0f} s left, ", *left) : "") + what;
}

std::string fitted_line(std::string text, std::size_t columns) {
  if (text.size() >= columns) {
    text.resize(columns > 0 ? columns - 1 : 0);
  }
  return text;
}

ProgressLine::ProgressLine(bool quiet, bool for_programs)
    : for_programs_(for_programs && !quiet),
      silent_(quiet || (!for_programs && isatty(STDERR_FILENO) == 0)),
      begin_(std::chrono::steady_clock::now()) {}

void ProgressLine::begin(std::string part) {
  part_ = std::move(part);
  begin_ = std::chrono::steady_clock::now();
  first_.reset();
  share_ = 0.0;
  print(part_ + " ...");
}

void ProgressLine::show(double share, const std::string& what) {
  first_ = first_.value_or(share);
  share_ = share;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  print(progress_line_text(part_, seconds_left(elapsed.count(), *first_, share), what));
}

void ProgressLine::show_percent(double share, const std::string& stage) {
  share_ = share;
  print(fmt::format("{}: {:.0f} %", stage, 100.0 * share));
}

void ProgressLine::print(const std::string& text) {
  if (silent_) {
    return;
  }
  if (for_programs_) {
    std::fprintf(stderr, "progress %.3f %s\n", share_, text.c_str());
    return;
  }
  std::fprintf(stderr, "\r\033[K%s", fitted_line(text, columns_of_terminal()).c_str());
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) {
    std::fputs("\r\033[K", stderr);
    shown_ = false;
  }
}

}  // namespace rayloc::cli
