// `rayloc predict`: expected localization accuracy in a room before access points are mounted.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/base/arrays/npz_file.h"
#include "daemon/cli/command/verb.h"
#include "daemon/lab/draw/picture_bytes.h"
#include "daemon/lab/predict/planned_room.h"
#include "daemon/lab/predict/prediction.h"
#include "daemon/lab/predict/prediction_report.h"
#include "daemon/lab/predict/proposals.h"
#include "daemon/site/model/site_copy.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

constexpr std::size_t kMaxConfused = 5;  // count, chosen: as many as a person reads
constexpr double kMinSpotStep = 0.4;     // [m], chosen: a finer grid adds no information
constexpr double kUsualPlaces = 60.0;    // count, chosen: 180 bursts, so shares to 4 %
constexpr double kCentimetre = 0.01;     // [m]

struct PredictArguments {
  std::string site;
  PlannedRoomOptions plan;
  double spacing_cm = 0.0;
  PredictionOptions options;
  double step = 0.0;  // [m]; 0: for about kUsualPlaces places
  std::size_t devices = 1;
  double rate = 50.0;
  double burst = 0.2;
  bool propose = false;
  bool moves = false;
  std::vector<std::string> out;
  bool quiet = false;
};

// A terminal line with the progress.
class Progress {
 public:
  explicit Progress(bool quiet) : silent_(quiet || isatty(STDERR_FILENO) == 0) {}
  void show(const char* what, double share) {
    if (!silent_) {
      std::fprintf(stderr, "\r\x1b[K%s: %.0f %%", what, 100.0 * share);
    }
  }
  void clear() const {
    if (!silent_) {
      std::fputs("\r\x1b[K", stderr);
    }
  }

 private:
  bool silent_;
};

Expected<void> write_output(const std::string& file,
                            const Prediction& prediction,
                            const RoomModel& room) {
  if (is_npz(file)) {
    return write_npz(prediction, file);
  }
  if (file.ends_with(".csv")) {
    return write_file(file, prediction_csv(prediction));
  }
  const auto bytes = draw::picture_bytes(prediction_picture(prediction, room), file);
  return bytes ? write_file(file, *bytes) : tl::make_unexpected(bytes.error());
}

Expected<void> check_arguments(const PredictArguments& arguments) {
  for (const std::string& file : arguments.out) {
    if (!is_npz(file) && !file.ends_with(".csv") && !file.ends_with(".svg") &&
        !file.ends_with(".png")) {
      return make_error(ErrorKind::kUsage, "--out " + file + ": write .png, .svg, .csv or .npz");
    }
  }
  const int mhz = arguments.plan.bandwidth_mhz;
  if (mhz != 0 && mhz != 20 && mhz != 40 && mhz != 80 && mhz != 160) {
    return make_error(ErrorKind::kUsage, "--bandwidth is 20, 40, 80 or 160 MHz");
  }
  return {};
}

std::string place_text(const Vec3d& place) {
  return fmt::format("({:.1f}, {:.1f})", place.x, place.y);
}

void print_prediction(const Prediction& prediction, const PredictArguments& arguments) {
  const double received =
      std::min(1.0, arguments.rate * arguments.burst / static_cast<double>(arguments.devices));
  fmt::print("{} places, {} bursts of {} frames at each\n",
             prediction.places.size(),
             arguments.options.draws,
             arguments.options.frames);
  fmt::print(
      "error: median {:.3f} m, 90 % below {:.3f} m\n", prediction.median_m, prediction.p90_m);
  fmt::print("located at another place (more than {:.1f} m off): {:.1f} % of bursts\n",
             kAnotherPlace,
             100.0 * prediction.another_place);
  fmt::print(
      "a device of {} is received in {:.0f} % of bursts\n", arguments.devices, 100.0 * received);
  for (const ConfusedPlace& one : confused_places(prediction, kMaxConfused)) {
    fmt::print("looks alike: {} is taken for {} in {} of {} bursts\n",
               place_text(one.place),
               place_text(one.taken_for),
               one.count,
               one.draws);
  }
}

void print_proposals(const std::vector<Proposal>& found) {
  fmt::print("\nmisplaced  median  proposal\n");
  for (const Proposal& one : found) {
    fmt::print("{:7.1f} %  {:4.2f} m  {}\n",
               100.0 * one.prediction.another_place,
               one.prediction.median_m,
               printable(one.what));
  }
}

// Frames per burst that one access point receives from one device.
std::size_t frames_of(const PredictArguments& arguments) {
  const double share = arguments.rate * arguments.burst / static_cast<double>(arguments.devices);
  return static_cast<std::size_t>(std::max(1.0, std::floor(share)));
}

Expected<void> run_predict(PredictArguments arguments) {
  if (auto checked = check_arguments(arguments); !checked) {
    return checked;
  }
  const auto site = load_site(arguments.site);
  if (!site) {
    return tl::make_unexpected(site.error());
  }
  if (arguments.spacing_cm > 0.0) {
    arguments.plan.spacing = kCentimetre * arguments.spacing_cm;
  }
  const auto room = planned_room(*site, arguments.plan);
  if (!room) {
    return tl::make_unexpected(room.error());
  }
  Progress progress(arguments.quiet);
  arguments.options.bandwidth_mhz = arguments.plan.bandwidth_mhz != 0 ? arguments.plan.bandwidth_mhz
                                                                      : site->carrier.bandwidth_mhz;
  arguments.options.frames = frames_of(arguments);
  arguments.options.progress = [&](double share) { progress.show("predicting", share); };
  if (arguments.step == 0.0) {
    arguments.step = std::max(kMinSpotStep, std::sqrt(room->area() / kUsualPlaces));
  }
  const std::vector<Vec3d> places = predicted_places(*room, arguments.step);
  if (places.empty()) {
    return make_error(ErrorKind::kUsage, "--step: no place of such a lattice is in the room");
  }
  const auto prediction =
      predict(std::make_shared<const RoomModel>(*room), places, arguments.options);
  progress.clear();
  if (!prediction) {
    return tl::make_unexpected(prediction.error());
  }
  print_prediction(*prediction, arguments);
  for (const std::string& file : arguments.out) {
    if (auto written = write_output(file, *prediction, *room); !written) {
      return written;
    }
  }
  if (!arguments.propose && !arguments.moves) {
    return {};
  }
  arguments.options.progress = [&](double share) { progress.show("comparing", share); };
  const auto found = proposals(*room, places, arguments.options, {true, arguments.moves});
  progress.clear();
  if (!found) {
    return tl::make_unexpected(found.error());
  }
  print_proposals(*found);
  return {};
}

void declare_plan(OptionParser& app, PredictArguments& arguments) {
  app.add_option("site", arguments.site, "directory with site.toml; need not be calibrated")
      ->required();
  app.add_option("--access-points", arguments.plan.access_points, "only these; default: all");
  app.add_option("--bandwidth",
                 arguments.plan.bandwidth_mhz,
                 "20, 40, 80 or 160 [MHz]; default: that of the site");
  app.add_option("--spacing",
                 arguments.spacing_cm,
                 "distance of neighbouring antennas of every row [cm]; default: as stated")
      ->check(in_range(0.5, 100.0));
  app.add_option("--devices", arguments.devices, "devices that share one channel")
      ->check(in_range(1, 10'000))
      ->capture_default_str();
  app.add_option(
         "--rate", arguments.rate, "frames that an access point receives from all devices [1/s]")
      ->check(in_range(0.1, 10'000.0))
      ->capture_default_str();
}

RunVerb declare_predict(OptionParser& app) {
  const auto arguments = std::make_shared<PredictArguments>();
  declare_plan(app, *arguments);
  app.add_option("--step", arguments->step, "between places [m]; default: about sixty places")
      ->check(in_range(0.05, 10.0));
  app.add_option("--draws", arguments->options.draws, "bursts at each place")
      ->check(in_range(1, 1000))
      ->capture_default_str();
  app.add_option("--seed", arguments->options.seed, "seed of all random draws")
      ->capture_default_str();
  app.add_flag(
      "--propose", arguments->propose, "also compare other distances of antennas, the best first");
  app.add_flag("--moves",
               arguments->moves,
               "and access points half a metre aside or turned by 45 degrees, which takes minutes");
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
