// `rayloc predict`: expected localization accuracy in a room before access points are mounted.
#include <memory>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/terminal/progress_line.h"
#include "daemon/cli/verbs/report/predict_report.h"
#include "daemon/lab/predict/predict_site.h"
#include "daemon/lab/predict/prediction_report.h"
#include "daemon/site/model/site.h"

namespace rayloc::cli {
namespace {

constexpr double kMetresPerCentimetre = 0.01;

struct PredictArguments {
  std::string site;
  SitePredictionOptions options;
  double spacing_cm = 0.0;
  bool propose = false;
  bool moves = false;
  std::vector<std::string> out;
  bool quiet = false;
};

Expected<void> run_predict(PredictArguments arguments) {
  for (const std::string& file : arguments.out) {
    RAYLOC_TRY(check_prediction_file(file));
  }
  RAYLOC_TRY(check_prediction(arguments.options));
  const auto site = load_site(arguments.site);
  RAYLOC_TRY(site);
  if (arguments.spacing_cm > 0.0) {
    arguments.options.plan.spacing = kMetresPerCentimetre * arguments.spacing_cm;
  }
  ProgressLine line(arguments.quiet);
  Observer observer;
  observer.on_progress = [&line](double share, const std::string& stage) {
    line.show_percent(share, stage);
  };
  const auto predicted = predict_site(*site, arguments.options, observer);
  line.clear();
  RAYLOC_TRY(predicted);
  print_prediction(*predicted, arguments.options.devices);
  for (const std::string& file : arguments.out) {
    RAYLOC_TRY(write_prediction(predicted->prediction, *predicted->room, file));
  }
  if (!arguments.propose && !arguments.moves) {
    return {};
  }
  const auto found = propose_changes(*predicted, {true, arguments.moves}, observer);
  line.clear();
  RAYLOC_TRY(found);
  print_proposals(*found);
  return {};
}

void declare_plan(OptionParser& app, PredictArguments& arguments) {
  app.add_option("site", arguments.site, "directory with site.toml; need not be calibrated")
      ->required();
  app.add_option(
      "--access-points", arguments.options.plan.access_points, "only these; default: all");
  app.add_option("--bandwidth",
                 arguments.options.plan.bandwidth_mhz,
                 "20, 40, 80 or 160 [MHz]; default: that of the site");
  app.add_option("--spacing",
                 arguments.spacing_cm,
                 "distance of neighbouring antennas of every row [cm]; default: as stated")
      ->check(in_range(0.5, 100.0));
  app.add_option("--devices", arguments.options.devices, "devices that share one channel")
      ->check(in_range(1, 10'000))
      ->capture_default_str();
  app.add_option("--rate",
                 arguments.options.rate,
                 "frames that an access point receives from all devices [1/s]")
      ->check(in_range(0.1, 10'000.0))
      ->capture_default_str();
}

RunVerb declare_predict(OptionParser& app) {
  const auto arguments = std::make_shared<PredictArguments>();
  declare_plan(app, *arguments);
  app.add_option(
         "--step", arguments->options.step, "between places [m]; default: about sixty places")
      ->check(in_range(0.05, 10.0));
  app.add_option("--draws", arguments->options.prediction.draws, "bursts at each place")
      ->check(in_range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", arguments->options.prediction.seed, "seed of all random draws")
      ->capture_default_str();
  app.add_flag(
      "--propose", arguments->propose, "also compare other distances of antennas, the best first");
  app.add_flag(
      "--moves",
      arguments->moves,
      "and access points half a metre aside or rotated by 45 degrees, which takes minutes");
  app.add_option("--out", arguments->out, "files to write: .png, .svg, .csv, .npz");
  app.add_flag("--quiet", arguments->quiet, "no progress on stderr");
  return [arguments] { return run_predict(*arguments); };
}

}  // namespace

extern const Verb kPredict;
const Verb kPredict = {"predict",
                       "Predict the accuracy in a room, before buying",
                       "rayloc predict office --propose --out office.png office.csv office.npz\n"
                       "  rayloc predict office --access-points ap1 --bandwidth 80 --spacing 2.9\n"
                       "Channels are drawn from the distribution that the likelihood assumes after "
                       "a usual calibration; objects that the plan lacks make errors larger",
                       declare_predict};

}  // namespace rayloc::cli
