// The kinds of runs of a calibration at a terminal: progress and results are printed on stderr, and
// a signal stops a long run.
#pragma once

#include "daemon/cli/calibration/plan_report.h"
#include "daemon/lab/calibrate/calibrate.h"
#include "daemon/lab/calibrate/calibrate_plan.h"
#include "daemon/lab/calibrate/calibrate_rechain.h"
#include "daemon/lab/calibrate/unsurveyed/calibrate_unsurveyed.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct RunOutput {
  bool quiet = false;     // only warnings, failures and stops
  bool progress = false;  // progress lines for programs: also if `quiet`, or stderr is no terminal
};

// run_calibration(). Once the fit has begun, the first SIGINT or SIGTERM stops it; the process ends
// after the last good state is written. For one thread of the process.
Expected<CalibrationOutcome> calibrate_survey(CalibrateArguments arguments, RunOutput output);

// run_unsurveyed(), with the same signals.
Expected<void> calibrate_unsurveyed(UnsurveyedArguments arguments, bool quiet);

// run_rechain() and its table of chains.
Expected<void> renew_chains(const RechainArguments& arguments, bool quiet);

// run_plan() and its files.
Expected<void> plan_points(const PlanArguments& arguments, const PlanOutput& output);

}  // namespace rayloc::cli
