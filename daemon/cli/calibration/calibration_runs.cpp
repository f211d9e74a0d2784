#include "daemon/cli/calibration/calibration_runs.h"

#include "daemon/cli/calibration/calibration_summary.h"
#include "daemon/cli/calibration/chain_report.h"
#include "daemon/cli/calibration/terminal_observer.h"
#include "daemon/cli/terminal/progress_line.h"
#include "daemon/cli/terminal/stop_signal.h"
#include "daemon/cli/terminal/terminal_notes.h"

namespace rayloc::cli {
namespace {

FitControl control_by_signal() { return {StopSignal::install_once, StopSignal::requested}; }

}  // namespace

Expected<CalibrationOutcome> calibrate_survey(CalibrateArguments arguments, RunOutput output) {
  const TerminalReport report{arguments.site, arguments.out, output.quiet};
  ProgressLine line(output.quiet && !output.progress, output.progress);
  arguments.control = control_by_signal();
  const auto result = run_calibration(arguments, terminal_observer(line, report));
  line.clear();
  RAYLOC_TRY(result);
  print_result(*result, report);
  StopSignal::end_if_requested();
  return result->outcome;
}

Expected<void> calibrate_unsurveyed(UnsurveyedArguments arguments, bool quiet) {
  const TerminalReport report{arguments.site, arguments.out, quiet};
  ProgressLine line(quiet);
  arguments.control = control_by_signal();
  UnsurveyedObserver observer{terminal_observer(line, report), {}, {}};
  observer.on_chains = [quiet](const RechainResult& chains) {
    if (!quiet) {
      print_chains(chains, true);
    }
  };
  observer.on_calibration = [&](const CalibrationResult& calibration) {
    line.clear();
    print_result(calibration, report);
  };
  const auto outcome = run_unsurveyed(arguments, observer);
  line.clear();
  RAYLOC_TRY(outcome);
  StopSignal::end_if_requested();
  return {};
}

Expected<void> renew_chains(const RechainArguments& arguments, bool quiet) {
  const auto chains = run_rechain(arguments, terminal_notes(quiet));
  RAYLOC_TRY(chains);
  if (!quiet) {
    print_chains(*chains, arguments.unsurveyed);
  }
  return {};
}

Expected<void> plan_points(const PlanArguments& arguments, const PlanOutput& output) {
  const auto planned = run_plan(arguments, terminal_notes(output.quiet));
  return planned ? write_plan(*planned, output) : tl::make_unexpected(planned.error());
}

}  // namespace rayloc::cli
