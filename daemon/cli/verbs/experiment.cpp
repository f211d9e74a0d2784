// `rayloc experiment`: studies on simulated captures, in one report.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/command/file_error.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/experiment/condition_store.h"
#include "daemon/lab/experiment/experiment_file.h"
#include "daemon/lab/experiment/experiment_report.h"
#include "daemon/lab/experiment/run_experiment.h"
#include "daemon/site/model/site_copy.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

struct ExperimentArguments {
  std::string file;
  std::string out;
  std::vector<std::string> studies;  // names; empty: all
  bool resume = false;
  bool force = false;
  bool progress = false;
  bool quiet = false;
};

void show_progress(const Study& study, std::size_t done, const ConditionResult& result) {
  std::fprintf(stderr,
               "\r\033[K%s: %zu of %zu, median %.3f m%s",
               study.name.c_str(),
               done,
               study.conditions.size(),
               result.statistics.median_m,
               done == study.conditions.size() ? "\n" : "");
}

// Lines "progress SHARE TEXT" for programs, the share of all conditions of the experiment.
class ProgressLines {
 public:
  explicit ProgressLines(const Experiment& experiment) {
    for (const Study& study : experiment.studies) {
      all_ += study.conditions.size();
    }
    std::fprintf(stderr, "progress 0.000 0 of %zu conditions\n", all_);
  }

  void print(const Study& study, std::size_t done, const ConditionResult& result) {
    ++done_;
    std::fprintf(stderr,
                 "progress %.3f %s: %zu of %zu, median %.3f m\n",
                 static_cast<double>(done_) / static_cast<double>(all_),
                 printable(study.name).c_str(),
                 done,
                 study.conditions.size(),
                 result.statistics.median_m);
  }

 private:
  std::size_t all_ = 0;
  std::size_t done_ = 0;
};

// The progress as the arguments request it: for programs, on a terminal, or none.
StudyProgress progress_of(const ExperimentArguments& arguments, const Experiment& experiment) {
  if (arguments.progress) {
    const auto lines = std::make_shared<ProgressLines>(experiment);
    return [lines](const Study& study, std::size_t done, const ConditionResult& result) {
      lines->print(study, done, result);
    };
  }
  if (!arguments.quiet && ::isatty(STDERR_FILENO) == 1) {
    return show_progress;
  }
  return [](const Study& /*study*/, std::size_t /*done*/, const ConditionResult& /*result*/) {};
}

Expected<void> run_experiment_verb(const ExperimentArguments& arguments) {
  auto experiment = load_experiment(arguments.file);
  if (!experiment) {
    return report_file_error(experiment.error());
  }
  RAYLOC_TRY(keep_studies(arguments.studies, *experiment));
  const std::filesystem::path directory = arguments.out;
  RAYLOC_TRY(prepare_output(directory, arguments.force || arguments.resume));
  const auto results = run_experiment(*experiment,
                                      progress_of(arguments, *experiment),
                                      condition_store(directory, arguments.resume));
  RAYLOC_TRY(results);
  RAYLOC_TRY(write_experiment_report(directory, *experiment, *results));
  if (!arguments.quiet) {
    std::fprintf(stderr, "%s\n", (directory / "report.html").c_str());
  }
  return {};
}

RunVerb declare_experiment(OptionParser& app) {
  const auto arguments = std::make_shared<ExperimentArguments>();
  app.add_option("FILE", arguments->file, "Experiment file (TOML)")->required();
  app.add_option("--out",
                 arguments->out,
                 "Directory for report.html, report.json, report.csv and errors.csv")
      ->required();
  app.add_option("--study", arguments->studies, "Run only the studies with these names");
  app.add_flag("--resume",
               arguments->resume,
               "Continue an interrupted run in --out; completed conditions are not run again");
  app.add_flag("--force", arguments->force, "Write into a directory that is not empty");
  app.add_flag("--progress",
               arguments->progress,
               "For programs: lines \"progress SHARE TEXT\" on standard error, also with --quiet");
  app.add_flag("--quiet", arguments->quiet, "Print no progress and no messages except errors");
  app.footer(app.get_footer() + R"(

A file (the paper's studies are in deploy/experiments):
  name = "Clutter"
  seed = 1                        # seed of all random draws
  [defaults]                      # keys of all studies, one value each
  room = "rooms/office.toml"      # relative to this file
  [[study]]
  name = "boxes"
  claim = "expected result"       # printed beside the figures
  method = ["rayloc", "paper"]    # a list is an axis; all combinations are run
  boxes = [2, 4, 6, 8, 10]
  over = "boxes"                  # x axis of the charts; default: the first numeric axis

Keys and their defaults:
)" + experiment_help());
  return [arguments] { return run_experiment_verb(*arguments); };
}

}  // namespace

extern const Verb kExperiment;
const Verb kExperiment = {"experiment",
                          "Run studies on simulated captures and report them",
                          "rayloc experiment deploy/experiments/ablation.toml --out ablation\n\n"
                          "The captures are simulated with the propagation model that the methods "
                          "use. They compare methods and conditions; they do not predict the "
                          "accuracy in a real room.",
                          declare_experiment};

}  // namespace rayloc::cli
