// Observers that report the notes and the progress of a calibration on stderr.
#pragma once

#include "daemon/base/observer.h"
#include "daemon/cli/calibration/calibration_progress.h"
#include "daemon/cli/calibration/calibration_summary.h"
#include "daemon/lab/calibrate/fit_observer.h"

namespace rayloc::cli {

// Shows the progress in `line` and removes the line before a message. For a quiet user warnings and
// verdict are printed, notes are not. REQUIRES: `line` outlives the observer.
FitObserver terminal_observer(CalibrationProgressLine& line, const TerminalReport& report);

}  // namespace rayloc::cli
