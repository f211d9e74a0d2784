// Final summary of a calibration on stderr.
#pragma once

#include <string>

#include "daemon/lab/calibrate/calibrate.h"

namespace rayloc::cli {

// Folders as on the command line, and how much is printed.
struct TerminalReport {
  std::string site;
  std::string out;
  bool quiet = false;
};

// The held-out errors of the fit. REQUIRES: there was a fit.
void print_summary(const CalibrationResult& result);

// The reasons of a failure; `site` as in TerminalReport. REQUIRES: the calibration failed.
void print_verdict(const CalibrationVerdict& verdict, const std::string& site);

// After a run: why no site was written, and the state of the output after a stop. The summary, and
// the verdict of a site that is written all the same, are printed before the files are written.
void print_result(const CalibrationResult& result, const TerminalReport& report);

}  // namespace rayloc::cli
