#include "daemon/cli/calibration/terminal_observer.h"

#include <cstdio>
#include <string>

namespace rayloc::cli {
namespace {

void print_message(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

}  // namespace

FitObserver terminal_observer(CalibrationProgressLine& line, const TerminalReport& report) {
  FitObserver observer;
  observer.on_part = [&line](const std::string& part) { line.begin(part); };
  observer.on_step = [&line](const CalibrationProgress& progress) { line.show(progress); };
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
