// `rayloc train`: its arguments and their use.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/progress_line.h"
#include "daemon/cli/verbs/report/train_report.h"
#include "daemon/lab/train/train_inputs.h"
#include "daemon/lab/train/train_method.h"
#include "daemon/lab/train/trained_site.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/survey/time_offset.h"

namespace rayloc::cli {
namespace {

struct TrainArguments {
  TrainOptions train;
  std::string out;
  bool resume = false;
  bool quiet = false;
};

// Trains with a line of progress on the terminal, which is removed before other output.
Expected<TrainedMethod> train_on_terminal(const TrainInputs& inputs,
                                          const TrainArguments& arguments) {
  ProgressLine line(arguments.quiet);
  line.begin("train " + arguments.train.method);
  Observer observer;
  observer.on_progress = [&line](double share, const std::string& stage) {
    line.show(share, stage);
  };
  observer.on_note = [&line](const std::string& note) {
    line.clear();
    std::fprintf(stderr, "%s\n", note.c_str());
  };
  const TrainCheckpoints checkpoints{std::filesystem::path(arguments.out) / "training",
                                     arguments.resume};
  return train_method(inputs, checkpoints, observer, {});
}

Expected<void> run_train(const TrainArguments& arguments) {
  TrainOptions options = arguments.train;
  options.out = arguments.out;
  options.force = options.force || arguments.resume;
  const auto inputs = read_train_inputs(options);
  RAYLOC_TRY(inputs);
  RAYLOC_TRY(prepare_output(options.out, options.force));
  const auto trained = train_on_terminal(*inputs, arguments);
  RAYLOC_TRY(trained);
  RAYLOC_TRY(write_trained_site(*inputs, *trained, options.out));
  if (!arguments.quiet) {
    print_trained(*inputs, *trained);
  }
  return {};
}

RunVerb declare_train(OptionParser& app) {
  const auto options = std::make_shared<TrainArguments>();
  TrainOptions& train = options->train;
  app.add_option("site", train.site, "calibrated site: directory with site.toml")->required();
  app.add_option("--method", train.method, "that learns")
      ->check(one_of(trained_methods()))
      ->required();
  app.add_option("--capture", train.survey.captures, "recordings of the survey: [AP=]FILE")
      ->required();
  app.add_option("--points",
                 train.survey.points,
                 "surveyed positions of the device, or the person: t_start,t_end,x,y,z")
      ->required();
  app.add_option("--time-offset", train.time_offset, kTimeOffsetHelp);
  app.add_option("--empty",
                 train.survey.empty,
                 "recordings of the empty room, of methods that locate people: [AP=]FILE");
  app.add_option("--out", options->out, "folder to create: the site with what was learned")
      ->required();
  app.add_option("--baseline",
                 train.baseline,
                 "KEY=VALUE: settings of the method, as `rayloc replay` has them");
  app.add_option("--holdout", train.holdout, "share of the points kept for checking")
      ->capture_default_str();
  app.add_option("--seed", train.seed, "seed of the draw of those points, and of the method")
      ->capture_default_str();
  app.add_flag("--resume", options->resume, "continues the training that was interrupted in --out");
  app.add_flag("--force", train.force, "write into a folder that is not empty");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return run_train(*options); };
}

}  // namespace

extern const Verb kTrain;
const Verb kTrain = {"train",
                     "Let a method learn from a survey what it needs beside the calibration",
                     "rayloc train office-calibrated --method spotfi --capture ap1=survey.pcap "
                     "--points survey.csv --out office-trained",
                     declare_train};

}  // namespace rayloc::cli
