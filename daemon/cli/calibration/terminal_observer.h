// Observers that report the notes and the progress of a calibration on stderr.
#pragma once

#include <string>

#include "daemon/base/observer.h"
#include "daemon/cli/calibration/calibration_summary.h"
#include "daemon/cli/terminal/progress_line.h"
#include "daemon/lab/calibrate/fit_observer.h"
#include "engine/calibrate/room_calibration.h"

namespace rayloc::cli {

// "57 points, fit, step 12, loss 0.3121, held-out 0.871".
std::string step_text(const CalibrationProgress& progress);

// Shows the progress in `line` and removes the line before a message. For a quiet user warnings and
// verdict are printed, notes are not. REQUIRES: `line` outlives the observer.
FitObserver terminal_observer(ProgressLine& line, const TerminalReport& report);

}  // namespace rayloc::cli
