// `rayloc calibrate`: from a site and a survey to a calibrated site.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/cli/calibration_inputs.h"
#include "daemon/cli/verb.h"
#include "daemon/site/calibration_file.h"
#include "daemon/site/content_hash.h"
#include "daemon/site/room_model.h"
#include "daemon/site/site_copy.h"
#include "engine/calibrate/access_point_fit.h"
#include "engine/localize/localizer.h"

namespace rayloc::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string site;
  std::vector<std::string> captures;
  std::string points;
  std::string out;
  double holdout = 0.2;
  std::uint64_t seed = 1;
  bool gains_only = false;
  bool force = false;
  bool quiet = false;
};

// What is known of one access point after the fit.
struct Result {
  std::size_t index = 0;
  AccessPointFit fit;    // on all points
  AccessPointFit train;  // without those held out
  std::size_t points = 0;
  double before = 0.0;  // squared correlation on the points held out
  double after = 0.0;
};

struct Coverage {
  double temper = 0.0;
  std::size_t inside = 0;  // truths within the stated 95 % radius
  std::size_t fixes = 0;
  std::size_t points = 0;
  double median = 0.0;  // [m], horizontal error
};

// Which points are held out: a share of them, drawn without replacement; the same for each access
// point.
std::vector<bool> draw_holdout(std::size_t count, double share, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[random() % i]);
  }
  std::vector<bool> held(count);
  const auto most = static_cast<std::size_t>(share * static_cast<double>(count));
  for (std::size_t i = 0; i < most; ++i) {
    held[order[i]] = true;
  }
  return held;
}

// The bursts of one access point at the points for which `take` holds.
template <typename Take>
std::vector<CalibrationSample> samples_of(const CalibrationInputs& inputs,
                                          const RoomModel& room,
                                          std::size_t ap,
                                          const Take& take,
                                          std::vector<RefusedInput>* refused) {
  std::vector<CalibrationSample> samples;
  const BurstRequest request{static_cast<int>(ap), room.grid, room.access_points[ap].cores, {}};
  for (std::size_t i = 0; i < inputs.points.size(); ++i) {
    if (!take(i)) {
      continue;
    }
    const SurveyedFrames& spot = inputs.points[i];
    auto burst = combine_burst(spot.frames, request);
    if (burst) {
      samples.push_back({spot.point.position, std::move(burst->h)});
    } else if (refused != nullptr && burst.error().message != "no frames") {
      refused->push_back(
          {"line " + std::to_string(spot.point.line) + " " + room.access_points[ap].id,
           burst.error().message});
    }
  }
  return samples;
}

Expected<Result> fit_one(CalibrationInputs& inputs,
                         const RoomModel& room,
                         std::size_t ap,
                         const std::vector<bool>& held) {
  Result result;
  result.index = ap;
  const auto all = samples_of(
      inputs, room, ap, [](std::size_t) { return true; }, &inputs.refused);
  result.points = all.size();
  auto fit = AccessPointCalibrator(room, ap, all).fit();
  if (!fit) {
    return tl::make_unexpected(std::move(fit.error()));
  }
  result.fit = *std::move(fit);
  const auto train = AccessPointCalibrator(
      room,
      ap,
      samples_of(
          inputs, room, ap, [&](std::size_t i) { return !held[i]; }, nullptr));
  auto trained = train.fit();
  if (!trained) {
    trained.error().message += " after holding out; use a smaller --holdout";
    return tl::make_unexpected(std::move(trained.error()));
  }
  result.train = *std::move(trained);
  const AccessPointCalibrator test(
      room,
      ap,
      samples_of(
          inputs, room, ap, [&](std::size_t i) { return held[i]; }, nullptr));
  result.before = test.correlation(nullptr);
  result.after = test.correlation(&result.train);
  return result;
}

void apply(const AccessPointFit& fit, RoomAccessPoint& ap) {
  ap.gains = fit.gains;
  ap.error = fit.error();
  ap.array.pose.orientation.yaw += fit.yaw_offset.value;
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

Coverage cover(const Localizer& localizer,
               const CalibrationInputs& inputs,
               const std::vector<bool>& held,
               double temper) {
  Coverage coverage;
  coverage.temper = temper;
  std::vector<double> errors;
  for (std::size_t i = 0; i < inputs.points.size(); ++i) {
    if (!held[i] || inputs.points[i].frames.empty()) {
      continue;
    }
    ++coverage.points;
    const auto estimate = localizer.locate(inputs.points[i].frames, temper);
    if (!estimate.position) {
      continue;
    }
    const Vec3d& truth = inputs.points[i].point.position;
    const double error = std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
    ++coverage.fixes;
    coverage.inside += error <= estimate.accuracy_m ? 1 : 0;
    errors.push_back(error);
  }
  coverage.median = median(std::move(errors));
  return coverage;
}

// The largest exponent of the likelihood whose 95 % regions hold 95 % of the points held out. With
// few points held out nothing can be said, and the default stays.
constexpr std::size_t kLeastForTemper = 10;
constexpr double kConfidence = 0.95;

Expected<std::vector<Coverage>> fit_temper(RoomModel room,
                                           const CalibrationInputs& inputs,
                                           const std::vector<Result>& results,
                                           const std::vector<bool>& held,
                                           CalibratedValue& temper) {
  temper = {room.temper, room.temper, 0.0};
  for (const Result& result : results) {
    apply(result.train, room.access_points[result.index]);
  }
  const auto localizer = Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
  if (!localizer) {
    return tl::make_unexpected(localizer.error());
  }
  std::vector<Coverage> scan;
  for (const double exponent : {1.0, 0.8, 0.6, 0.45, 0.3, 0.2, 0.13, 0.09, 0.06}) {
    scan.push_back(cover(*localizer, inputs, held, exponent));
    const Coverage& last = scan.back();
    if (last.fixes < kLeastForTemper) {
      break;
    }
    temper.value = exponent;
    if (static_cast<double>(last.inside) >= kConfidence * static_cast<double>(last.fixes)) {
      break;
    }
  }
  return scan;
}

CalibratedValue calibrated(const FittedValue& value) {
  return {value.value, value.prior, value.sigma};
}

CalibratedAccessPoint calibrated(const Result& result, const RoomModel& room) {
  const AccessPointFit& fit = result.fit;
  return {room.access_points[result.index].id,
          fit.samples_used,
          calibrated(fit.yaw_offset),
          calibrated(fit.plan_tolerance),
          calibrated(fit.diffuse),
          calibrated(fit.diffuse_exponent),
          calibrated(fit.noise),
          fit.gains,
          fit.gain_sigma};
}

Json parameter(const std::string& name, const char* unit, const CalibratedValue& value) {
  return {{"name", name},
          {"value", value.value},
          {"unit", unit},
          {"prior", value.prior},
          {"sigma", value.sigma > 0.0 ? Json(value.sigma) : Json(nullptr)}};
}

// Mean gain of a chain against the first, in dB and degrees.
void add_chain_parameters(const CalibratedAccessPoint& ap, Json& parameters) {
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  const std::size_t tones = ap.gains.grid.size();
  for (std::size_t core = 1; core < ap.gains.cores.size(); ++core) {
    std::complex<double> ratio;
    double power = 0.0;
    for (std::size_t k = 0; k < tones; ++k) {
      ratio += ap.gains.gain[core * tones + k] * std::conj(ap.gains.gain[k]);
      power += std::norm(ap.gains.gain[k]);
    }
    ratio /= power;
    const std::string name = ap.id + ".core" + std::to_string(ap.gains.cores[core]) + "/core" +
                             std::to_string(ap.gains.cores[0]);
    const double sigma = std::hypot(ap.gain_sigma[core], ap.gain_sigma[0]);
    constexpr double kDecibels = 8.685889638065037;  // of one neper
    parameters.push_back(parameter(
        name + ".gain", "dB", {kDecibels * std::log(std::abs(ratio)), 0.0, kDecibels * sigma}));
    parameters.push_back(
        parameter(name + ".phase", "deg", {kDegrees * std::arg(ratio), 0.0, kDegrees * sigma}));
  }
}

Json report_of(const CalibrationFile& calibration,
               const std::vector<Result>& results,
               const std::vector<Coverage>& scan,
               const CalibrationInputs& inputs,
               const Options& options) {
  Json heldout = Json::object();
  Json parameters = Json::array();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CalibratedAccessPoint& ap = calibration.access_points[i];
    heldout[ap.id] = {{"before", results[i].before}, {"after", results[i].after}};
    for (const NamedValue& named : calibrated_values()) {
      parameters.push_back(parameter(ap.id + "." + named.name, named.unit, ap.*named.value));
    }
    add_chain_parameters(ap, parameters);
  }
  parameters.push_back(parameter("temper", "1", calibration.temper));
  Json refused = Json::array();
  for (const RefusedInput& one : inputs.refused) {
    refused.push_back({{"what", one.what}, {"reason", one.reason}});
  }
  Json coverage = Json::array();
  for (const Coverage& one : scan) {
    coverage.push_back({{"temper", one.temper},
                        {"points", one.points},
                        {"fixes", one.fixes},
                        {"within_accuracy_95", one.inside},
                        {"median_error_m", one.median}});
  }
  return {{"method", "gains-only"},
          {"calibration_id", calibration.id},
          {"seed", options.seed},
          {"holdout", options.holdout},
          {"points", inputs.points.size()},
          {"heldout_is", "mean squared normalised correlation of measured and expected CSI"},
          {"heldout", std::move(heldout)},
          {"heldout_fixes", std::move(coverage)},
          {"parameters", std::move(parameters)},
          {"refused", std::move(refused)}};
}

void print_summary(const CalibrationFile& calibration,
                   const std::vector<Result>& results,
                   const std::vector<Coverage>& scan,
                   const CalibrationInputs& inputs) {
  for (std::size_t i = 0; i < results.size(); ++i) {
    std::fprintf(stderr,
                 "%s: %zu points; held-out correlation %.3f -> %.3f; yaw %+.2f deg\n",
                 calibration.access_points[i].id.c_str(),
                 results[i].points,
                 results[i].before,
                 results[i].after,
                 results[i].fit.yaw_offset.value * 57.29577951308232);
  }
  if (!scan.empty()) {
    std::fprintf(stderr,
                 "held-out fixes: %zu of %zu points, median error %.3f m, %zu within the stated "
                 "95 %% radius (likelihood exponent %.2f)\n",
                 scan.back().fixes,
                 scan.back().points,
                 scan.back().median,
                 scan.back().inside,
                 calibration.temper.value);
  }
  if (!inputs.refused.empty()) {
    std::fprintf(stderr,
                 "%zu inputs refused, the first: %s: %s; see report.json\n",
                 inputs.refused.size(),
                 inputs.refused.front().what.c_str(),
                 inputs.refused.front().reason.c_str());
  }
}

Expected<void> check(const Options& options) {
  if (!options.gains_only) {
    return make_error(ErrorKind::kUsage,
                      "only the chain gains can be calibrated so far: add --gains-only (surfaces "
                      "and materials stay those of the floor plan)");
  }
  if (!(options.holdout >= 0.0 && options.holdout <= 0.8)) {
    return make_error(ErrorKind::kUsage, "--holdout is a share of the points from 0 to 0.8");
  }
  return {};
}

struct Measured {
  Site site;
  CalibrationInputs inputs;
  RoomModel room;
};

Expected<Measured> measure(const Options& options) {
  auto site = load_site(options.site);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  std::vector<std::string> ids;
  for (const SiteAccessPoint& ap : site->access_points) {
    ids.push_back(ap.id);
  }
  const auto captures = resolve_captures(options.captures, ids);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  auto inputs = read_calibration_inputs(*site, *captures, options.points);
  if (!inputs) {
    return tl::make_unexpected(std::move(inputs.error()));
  }
  Site uncalibrated = *site;  // starts from the survey, not from an earlier calibration
  uncalibrated.calibration_file.reset();
  auto room = load_room_model(uncalibrated);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  return Measured{*std::move(site), *std::move(inputs), *std::move(room)};
}

Expected<void> run(const Options& options) {
  if (auto checked = check(options); !checked) {
    return checked;
  }
  auto measured = measure(options);
  if (!measured) {
    return tl::make_unexpected(std::move(measured.error()));
  }
  auto& [site, inputs, room] = *measured;
  if (auto prepared = prepare_output(options.out, options.force); !prepared) {
    return prepared;
  }
  const auto held = draw_holdout(inputs.points.size(), options.holdout, options.seed);
  CalibrationFile calibration;
  std::vector<Result> results;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    if (!inputs.recorded[i]) {
      inputs.refused.push_back({room.access_points[i].id, "no recording: stays uncalibrated"});
      continue;
    }
    auto result = fit_one(inputs, room, i, held);
    if (!result) {
      return tl::make_unexpected(std::move(result.error()));
    }
    calibration.access_points.push_back(calibrated(*result, room));
    results.push_back(*std::move(result));
  }
  const auto scan = fit_temper(room, inputs, results, held, calibration.temper);
  if (!scan) {
    return tl::make_unexpected(scan.error());
  }
  ContentHash id;
  id.add(inputs.content);
  id.add(room.scene_hash);
  id.add(options.seed);
  id.add(options.holdout);
  calibration.id = id.text();
  calibration.scene_hash = room.scene_hash;
  calibration.points_hash = inputs.points_hash;
  if (auto written = write_site(site, to_toml(calibration), options.out); !written) {
    return written;
  }
  if (!options.quiet) {
    print_summary(calibration, results, *scan, inputs);
  }
  return write_file(std::filesystem::path(options.out) / "report.json",
                    report_of(calibration, results, *scan, inputs, options).dump(2) + "\n");
}

RunVerb declare(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("site", options->site, "directory with site.toml")->required();
  app.add_option("--capture", options->captures, "recordings of the survey: [AP=]FILE")->required();
  app.add_option("--points", options->points, "where the device stood: t_start,t_end,x,y,z")
      ->required();
  app.add_option("--out", options->out, "folder to create: the calibrated site")->required();
  app.add_flag("--gains-only", options->gains_only, "chain gains and yaw; the floor plan stays");
  app.add_option("--holdout", options->holdout, "share of the points kept for checking");
  app.add_option("--seed", options->seed, "of the draw of those points");
  app.add_flag("--force", options->force, "write into a folder that is not empty");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return run(*options); };
}

}  // namespace

extern const Verb kCalibrate;
const Verb kCalibrate = {"calibrate",
                         "Calibrate a site from a survey",
                         "rayloc calibrate office --capture ap1=survey.pcap --points survey.csv "
                         "--gains-only --out office-calibrated",
                         declare};

}  // namespace rayloc::cli
