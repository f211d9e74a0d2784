#include "daemon/cli/calibration/terminal_observer.h"

#include <cstdio>
#include <string>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {
namespace {

void print_message(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

}  // namespace

std::string step_text(const CalibrationProgress& progress) {
  return fmt::format("{} points, {}, step {}, loss {:.4g}, held-out {:.3f}",
                     progress.points,
                     progress.step.stage,
                     progress.step.iteration,
                     progress.step.loss,
                     progress.step.heldout);
}

FitObserver terminal_observer(ProgressLine& line, const TerminalReport& report) {
  FitObserver observer;
  observer.on_part = [&line](const std::string& part) { line.begin(part); };
  observer.on_step = [&line](const CalibrationProgress& progress) {
    line.show(progress.share, step_text(progress));
  };
  observer.on_warning = [&line](const std::string& warning) {
    line.clear();
    print_message(warning);
  };
  observer.on_verdict = [&line, site = report.site](const CalibrationVerdict& verdict) {
    line.clear();
    print_verdict(verdict, site);
  };
  if (!report.quiet) {
    observer.on_note = observer.on_warning;
    observer.on_result = [&line](const CalibrationResult& result) {
      line.clear();
      print_summary(result);
    };
  }
  return observer;
}

}  // namespace rayloc::cli
