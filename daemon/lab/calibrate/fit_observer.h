// FitObserver: receives the progress, the messages and the early results of a calibration.
#pragma once

#include <functional>
#include <string>

#include "daemon/base/observer.h"
#include "daemon/lab/calibrate/report/calibration_verdict.h"
#include "engine/calibrate/room_calibration.h"

namespace rayloc {

struct CalibrationResult;  // calibrate.h

// Empty functions: nothing is reported. All are called from the thread of the calibration.
// `on_progress` receives the share of the current part, and its stage.
struct FitObserver : Observer {
  // A part of the work begins: "joint", or a description of work that reports no steps.
  std::function<void(const std::string& part)> on_part;
  std::function<void(const CalibrationProgress& progress)> on_step;  // within the part
  // A message that a user needs even without notes, without newline.
  std::function<void(const std::string& warning)> on_warning;
  // Reasons of a failure that `force` overrides: of survey or site before the fit, or of the fit.
  std::function<void(const CalibrationVerdict& verdict)> on_verdict;

  // Receives the result of the fit before any file is written, so that a full disk does not lose
  // it.
  std::function<void(const CalibrationResult& result)> on_result;

  void begin(const std::string& part) const {
    if (on_part) {
      on_part(part);
    }
  }
  void step(const CalibrationProgress& reached) const {
    progress(reached.share, reached.step.stage);
    if (on_step) {
      on_step(reached);
    }
  }
  void warn(const std::string& warning) const {
    if (on_warning) {
      on_warning(warning);
    }
  }
  void verdict(const CalibrationVerdict& found) const {
    if (on_verdict) {
      on_verdict(found);
    }
  }
  void result(const CalibrationResult& found) const {
    if (on_result) {
      on_result(found);
    }
  }
};

}  // namespace rayloc
