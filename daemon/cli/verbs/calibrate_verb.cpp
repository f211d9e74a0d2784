// The verb `rayloc calibrate`: its arguments and the choice of the run.
#include <cstddef>
#include <memory>
#include <string>

#include "daemon/base/exit_status.h"
#include "daemon/cli/calibration/calibration_runs.h"
#include "daemon/cli/calibration/fit_arguments.h"
#include "daemon/cli/command/verb.h"
#include "daemon/site/survey/time_offset.h"

namespace rayloc::cli {
namespace {

struct CalibrateOptions {
  CalibrateArguments calibrate;
  std::size_t plan_points = PlanArguments().points;
  std::string picture;
  std::string time_offset;
  RunOutput output;
  bool make_plan = false;
  bool rechain = false;
  bool unsurveyed = false;
  bool gains_only = false;
};

Expected<int> status_of(const Expected<void>& done) {
  return done.map([] { return 0; });
}

Expected<int> run_calibrate(const CalibrateOptions& options) {
  CalibrateArguments fit = options.calibrate;
  const bool quiet = options.output.quiet;
  if (options.make_plan) {
    return status_of(plan_points({fit.site, options.plan_points},
                                 {fit.out.empty() ? "-" : fit.out, options.picture, quiet}));
  }
  if (!options.time_offset.empty()) {
    const auto offset = parse_time_offset(options.time_offset);
    RAYLOC_TRY(offset);
    fit.time_offset = *offset;
  }
  if (options.unsurveyed) {
    if (fit.out.empty() || !fit.points.empty()) {
      return make_error(ErrorKind::kUsage, "--unsurveyed needs --out, and no --points");
    }
    return status_of(
        calibrate_unsurveyed({fit.site, fit.captures, fit.out, fit.seed, fit.force}, quiet));
  }
  if (options.rechain) {
    if (fit.captures.empty() || fit.out.empty()) {
      return make_error(ErrorKind::kUsage, "--rechain needs --capture and --out");
    }
    return status_of(renew_chains(
        {fit.site, fit.captures, fit.points, fit.time_offset, fit.out, fit.force}, quiet));
  }
  if (options.gains_only) {
    fit.method = "gains-only";
  }
  RAYLOC_TRY(check_fit_arguments(fit));
  return calibrate_survey(fit, options.output).map([](CalibrationOutcome verdict) {
    return verdict == CalibrationOutcome::kExplains ? 0 : kExitUnexplained;
  });
}

RunVerb declare_calibrate(OptionParser& app) {
  const auto options = std::make_shared<CalibrateOptions>();
  app.add_option("site", options->calibrate.site, "directory with site.toml")->required();
  app.add_option("--capture", options->calibrate.captures, "recordings of the survey: [AP=]FILE");
  app.add_option("--points",
                 options->calibrate.points,
                 "surveyed positions of the device: t_start,t_end,x,y,z");
  app.add_option("--time-offset", options->time_offset, kTimeOffsetHelp);
  app.add_option("--out",
                 options->calibrate.out,
                 "folder to create: the calibrated site; with --plan the csv (- is stdout)");
  app.add_option("--method",
                 options->calibrate.method,
                 "joint: surfaces, arrays, chains and materials together; paper: the published one")
      ->check(one_of({"joint", "paper"}))
      ->capture_default_str();
  app.add_flag(
      "--plan", options->make_plan, "proposes the points of a survey, before there is one");
  app.add_option("--plan-points",
                 options->plan_points,
                 "how many points to plan: 12 for a first day, 36 and 143 for more")
      ->capture_default_str();
  app.add_option("--picture", options->picture, "picture of the plan: .svg or .png");
  app.add_flag("--rechain",
               options->rechain,
               "only new chain gains, after a power cycle: from 1 to 3 --points, or without them "
               "from the devices that were recorded, wherever they were, and the site's fixed "
               "transmitters");
  app.add_flag(
      "--unsurveyed",
      options->unsurveyed,
      "no survey: from the plan and the devices that were recorded, wherever they were; without "
      "--capture raylocd learns the chains itself");
  app.add_flag("--gains-only", options->gains_only, "chain gains and yaw; the floor plan stays");
  app.add_flag(
      "--compare", options->calibrate.compare, "also runs the other method, for the report");
  app.add_option("--holdout", options->calibrate.holdout, "share of the points kept for checking")
      ->capture_default_str();
  app.add_option("--survey-error",
                 options->calibrate.survey_error,
                 "standard deviation of the surveyed points along each axis [m]: 0.005 is careful "
                 "work with a tape; the joint method estimates it when left out");
  app.add_option("--seed", options->calibrate.seed, "seed of the draw of those points")
      ->capture_default_str();
  app.add_flag("--resume",
               options->calibrate.resume,
               "continues the calibration that was interrupted in --out");
  app.add_flag(
      "--force",
      options->calibrate.force,
      "write into a folder that is not empty, and write a site that explains its survey no "
      "better than the plan does (the exit status is 79 all the same)");
  app.add_flag("--progress",
               options->output.progress,
               "for programs: lines \"progress SHARE TEXT\" on stderr, though it is no terminal");
  app.add_flag("--quiet", options->output.quiet, "no words on stderr");
  return [options] { return run_calibrate(*options); };
}

}  // namespace

extern const Verb kCalibrate;
const Verb kCalibrate = {"calibrate",
                         "Calibrate a site from a survey",
                         "rayloc calibrate --plan office --out plan.csv\n"
                         "  rayloc calibrate office --capture ap1=survey.pcap --points survey.csv "
                         "--out office-calibrated\n"
                         "  rayloc calibrate office-calibrated --rechain --capture ap1=now.pcap "
                         "--out office-today\n"
                         "  rayloc calibrate office --unsurveyed --capture ap1=walk1.pcap "
                         "ap2=walk2.pcap --out office-calibrated\n"
                         "Exit status 79: the calibration explains the survey no better than the "
                         "plan does, or the site contradicts it; standard error and report.json "
                         "state the reason, and without --force no site is written",
                         declare_calibrate};

}  // namespace rayloc::cli
