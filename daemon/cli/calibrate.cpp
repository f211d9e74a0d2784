#include "daemon/cli/calibrate.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/calibrate/access_point_stage.h"
#include "daemon/calibrate/calibrated_site.h"
#include "daemon/calibrate/calibration_report.h"
#include "daemon/calibrate/checkpoint_file.h"
#include "daemon/calibrate/held_out_fixes.h"
#include "daemon/calibrate/holdout.h"
#include "daemon/calibrate/inputs_hash.h"
#include "daemon/calibrate/level_stage.h"
#include "daemon/cli/calibration_inputs.h"
#include "daemon/cli/calibration_points.h"
#include "daemon/cli/calibration_progress.h"
#include "daemon/cli/calibration_summary.h"
#include "daemon/cli/scene_notes.h"
#include "daemon/cli/stop_signal.h"
#include "daemon/site/calibration_file.h"
#include "daemon/site/room_match.h"
#include "daemon/site/room_model.h"
#include "daemon/site/site_copy.h"
#include "engine/calibrate/draw_search.h"
#include "engine/calibrate/input_check.h"
#include "engine/calibrate/joint_calibration.h"
#include "engine/calibrate/paper_calibration.h"
#include "engine/scene/scene_hash.h"

namespace rayloc::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOldReference =
    "is of another calibration and left out: record the empty room again (rayloc reference)";

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;  // [KiB] on Linux
}

class Calibration {
 public:
  explicit Calibration(const CalibrateArguments& options) : options_(options) {}

  Expected<void> run();

 private:
  Expected<void> check_site();
  Expected<void> measure();
  Expected<void> refuse();
  Expected<void> fit_gains(const std::vector<std::string>& first_refusal);
  Expected<CalibrationMethodResult> calibrate(const std::string& method);
  Expected<RoomCalibration> jointly(const CalibrationObserver& observer, double& seconds);
  void keep(const StoredCheckpoint& state);
  bool go_on();
  bool can_resume() const { return options_.method == "joint"; }  // not by --compare
  void end(const std::vector<CalibrationMethodResult>& methods) const;
  Expected<void> fit_errors(const CalibrationMethodResult& method);
  void refuse_unreached(const AccessPointResult& result);
  std::vector<HeldOutSpot> spots(bool all) const;
  Expected<void> fit_certainty(const RoomModel& room);
  CalibrationReport report_of(const std::vector<CalibrationMethodResult>& methods,
                              const CalibrationFile& file) const;
  Expected<void> write(const std::vector<CalibrationMethodResult>& methods);
  // "points.csv:17"
  std::string place_of(std::size_t point) const {
    return options_.points + ":" + std::to_string(inputs_.points[point].point.line);
  }
  fs::path checkpoint() const { return fs::path(options_.out) / kCheckpointFile; }

  const CalibrateArguments& options_;
  Site site_;
  CalibrationInputs inputs_;
  RoomModel plan_;   // as surveyed
  RoomModel start_;  // with the gains and the yaw of the points that are not held out
  std::vector<CalibrationPoint> points_;
  std::vector<AccessPointResult> gains_;    // in the room of the plan
  std::vector<AccessPointResult> results_;  // in the calibrated room
  std::vector<HeldOutFixes> fixes_;
  std::string id_;  // of all inputs
  CalibrationProgressLine line_{options_.quiet};
  bool unkept_ = false;        // the last state could not be written
  bool told_to_stop_ = false;  // and said so
};

// What would be found out after minutes else.
Expected<void> Calibration::check_site() {
  if (site_.calibration_file) {
    return make_error(ErrorKind::kConfiguration,
                      options_.site +
                          ": is calibrated already; give the site as it was surveyed, from which "
                          "the priors count. After a power cycle --rechain is enough. To start "
                          "from the scene of this one all the same, take [calibration] and "
                          "[reference] out of a copy of its site.toml");
  }
  return check_output(options_.out, site_.directory, options_.force || options_.resume);
}

Expected<void> Calibration::measure() {
  auto site = load_site(options_.site);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  site_ = *std::move(site);
  if (auto checked = check_site(); !checked) {
    return checked;
  }
  const auto captures =
      resolve_captures(options_.captures, access_point_ids(site_), PerAccessPoint::kSeveral);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  auto room = load_room_model(site_);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  plan_ = *std::move(room);
  for (const std::string& warning : room_warnings(*plan_.scene, site_)) {
    std::fprintf(stderr, "%s\n", warning.c_str());
  }
  if (!options_.quiet) {
    print_scene_notes(*plan_.scene);
  }
  auto inputs = read_calibration_inputs(with_bounds(site_, plan_), *captures, options_.points);
  if (!inputs) {
    return tl::make_unexpected(std::move(inputs.error()));
  }
  inputs_ = *std::move(inputs);
  for (const std::string& note : inputs_.notes) {
    if (!options_.quiet) {
      std::fprintf(stderr, "%s\n", note.c_str());
    }
  }
  if (site_.reference_file) {  // it holds the phases of another calibration
    inputs_.refused.push_back({site_.reference_file->filename().string(), kOldReference});
    site_.reference_file.reset();
    if (!options_.quiet) {
      std::fprintf(stderr, "%s: [reference] %s\n", options_.site.c_str(), kOldReference);
    }
  }
  const CalibrationRequest request{
      options_.method, options_.holdout, options_.seed, options_.survey_error};
  id_ = inputs_hash(site_, plan_, request, inputs_.content);
  return {};
}

// Mistakes of the survey, and points that fit nowhere.
Expected<void> Calibration::refuse() {
  const auto refusals = check_calibration_inputs(plan_, points_);
  if (!refusals) {
    auto error = refusals.error();
    error.message = options_.points + ": " + error.message;
    return tl::make_unexpected(std::move(error));
  }
  for (const PointRefusal& refusal : *refusals) {
    inputs_.refused.push_back({place_of(refusal.point), refusal.reason});
    for (auto& h : points_[refusal.point].h) {
      h.clear();
    }
  }
  return {};
}

Expected<void> Calibration::fit_gains(const std::vector<std::string>& first_refusal) {
  start_ = plan_;
  for (std::size_t a = 0; a < plan_.access_points.size(); ++a) {
    if (!inputs_.recorded[a]) {
      inputs_.refused.push_back({plan_.access_points[a].id, "no recording: stays uncalibrated"});
      continue;
    }
    auto result = fit_access_point(plan_, a, points_, kExactSurvey, ArrayFit::kFitted);
    if (!result) {
      if (!first_refusal[a].empty()) {  // another bandwidth or other chains than the site states
        result.error().message += "; the first that cannot: " + first_refusal[a];
      }
      return tl::make_unexpected(std::move(result.error()));
    }
    apply(result->train, start_.access_points[a]);
    gains_.push_back(*std::move(result));
  }
  return {};
}

// Keeps the way from which --resume goes on; that it cannot is said once and ends nothing.
void Calibration::keep(const StoredCheckpoint& state) {
  const auto written = write_file(checkpoint(), to_json_text(state, id_));
  if (!written && !unkept_) {
    line_.clear();
    std::fprintf(stderr,
                 "warning: %s; after an interruption --resume cannot go on\n",
                 written.error().message.c_str());
  }
  unkept_ = !written;
}

Expected<RoomCalibration> Calibration::jointly(const CalibrationObserver& observer,
                                               double& seconds) {
  const auto begin = std::chrono::steady_clock::now();
  const auto since = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  JointCalibrationOptions joint;
  joint.seed = options_.seed;
  joint.priors.survey = options_.survey_error;
  StoredCheckpoint from;
  if (options_.resume) {
    auto loaded = load_checkpoint(checkpoint(), id_, start_, points_.size());
    if (!loaded) {
      return tl::make_unexpected(std::move(loaded.error()));
    }
    from = *std::move(loaded);
    joint.resume = &from.reached;
  }
  if (can_resume()) {
    joint.on_checkpoint = [&](const JointCheckpoint& state) {
      keep({state, from.seconds + since()});
    };
  }
  auto calibration = calibrate_from_draws(start_, points_, joint, usual_draws(points_), observer);
  seconds = from.seconds + since();
  return calibration;
}

bool Calibration::go_on() {
  if (StopSignal::requested() && !told_to_stop_) {
    told_to_stop_ = true;
    line_.clear();
    if (!options_.quiet) {
      std::fputs("interrupted: finishing with the last good state; once more ends at once\n",
                 stderr);
    }
    line_.begin("finishing");
  }
  return !told_to_stop_;
}

Expected<CalibrationMethodResult> Calibration::calibrate(const std::string& method) {
  CalibrationMethodResult result{method, {}, 0.0, plan_.trace};
  if (method == "gains-only") {
    result.calibration.room = plan_;
    for (const AccessPointResult& one : gains_) {
      result.calibration.points.insert(
          result.calibration.points.end(), one.fits.begin(), one.fits.end());
    }
    return result;
  }
  const PaperCalibrationOptions paper;
  result.rays = method == "paper"
                    ? TraceOptions{.max_depth = paper.max_depth, .softness = paper.softness}
                    : JointCalibrationOptions().trace;
  line_.begin(method);
  const auto observer = [&](const CalibrationProgress& progress) {
    line_.show(progress);
    return go_on();
  };
  const auto begin = std::chrono::steady_clock::now();
  auto calibration = method == "paper" ? calibrate_by_paper(start_, points_, paper, observer)
                                       : jointly(observer, result.seconds);
  if (!calibration) {
    return tl::make_unexpected(std::move(calibration.error()));
  }
  result.calibration = *std::move(calibration);
  count_yaw_from_survey(plan_, start_, result.calibration.parameters);
  if (method == "paper") {
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  return result;
}

// What the likelihood needs to know of the calibrated room. The joint calibration knows the arrays
// better than the likelihood does, which asks for less than all that was measured.
Expected<void> Calibration::fit_errors(const CalibrationMethodResult& method) {
  const RoomModel& room = method.calibration.room;
  const ArrayFit array = method.method == "joint" ? ArrayFit::kHeld : ArrayFit::kFitted;
  for (const AccessPointResult& gains : gains_) {
    auto result = fit_access_point(room, gains.index, points_, options_.survey_error, array);
    if (!result) {
      return tl::make_unexpected(std::move(result.error()));
    }
    refuse_unreached(*result);
    results_.push_back(*std::move(result));
  }
  return {};
}

// Points that were heard and have no fit.
void Calibration::refuse_unreached(const AccessPointResult& result) {
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const bool fits = std::any_of(
        result.fits.begin(), result.fits.end(), [&](const auto& fit) { return fit.point == p; });
    if (!fits && !points_[p].h[result.index].empty()) {
      inputs_.refused.push_back({place_of(p) + " " + plan_.access_points[result.index].id,
                                 "no ray of the calibrated room reaches it"});
    }
  }
}

// What was heard at the points held out, or at all that were not refused.
std::vector<HeldOutSpot> Calibration::spots(bool all) const {
  std::vector<HeldOutSpot> spots;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const auto& h = points_[p].h;
    const bool used = std::any_of(h.begin(), h.end(), [](const auto& one) { return !one.empty(); });
    if ((all ? used : points_[p].held_out) && !inputs_.points[p].frames.empty()) {
      spots.push_back({points_[p].position, inputs_.points[p].frames});
    }
  }
  return spots;
}

Expected<void> Calibration::fit_certainty(const RoomModel& room) {
  auto trained = std::make_shared<RoomModel>(room);
  for (AccessPointResult& result : results_) {
    result.levels = fit_levels(site_, room, result, spots(true), inputs_.refused);
    apply(result.train, trained->access_points[result.index]);
    trained->access_points[result.index].levels = result.levels;
  }
  auto fixes = fit_certainty_of(std::move(trained), spots(false), options_.survey_error);
  if (!fixes) {
    return tl::make_unexpected(std::move(fixes.error()));
  }
  fixes_ = *std::move(fixes);
  return {};
}

CalibrationReport Calibration::report_of(const std::vector<CalibrationMethodResult>& methods,
                                         const CalibrationFile& file) const {
  CalibrationReport report;
  report.site = site_.name;
  report.calibration_id = id_;
  report.holdout = options_.holdout;
  report.survey_error = options_.survey_error;
  report.seed = options_.seed;
  for (const RoomAccessPoint& ap : plan_.access_points) {
    report.access_points.push_back(ap.id);
  }
  for (const CalibrationPoint& point : points_) {
    report.positions.push_back(point.position);
    report.held_out.push_back(point.held_out);
  }
  report.before = plan_;
  report.methods = methods;
  auto& parameters = report.methods.front().calibration.parameters;
  for (const CalibratedAccessPoint& ap : file.access_points) {
    add_common_parameters(ap, parameters);
  }
  parameters.push_back({"temper", "1", file.temper.value, file.temper.prior, 0.0, 0.0});
  parameters.push_back(
      {"least_sigma", "m", file.least_sigma.value, file.least_sigma.prior, 0.0, 0.0});
  for (const AccessPointResult& result : results_) {
    report.located.insert(report.located.end(), result.fits.begin(), result.fits.end());
  }
  report.fixes = fixes_;
  report.refused = inputs_.refused;
  report.peak_memory_bytes = peak_memory();
  return report;
}

Expected<void> Calibration::write(const std::vector<CalibrationMethodResult>& methods) {
  const RoomModel& room = methods.front().calibration.room;
  const bool refined = methods.front().method != "gains-only";
  CalibrationFile file;
  file.id = id_;
  file.method = methods.front().method;
  file.scene_hash = scene_hash(*room.scene);
  file.points_hash = inputs_.points_hash;
  file.temper = {fixes_.back().temper, plan_.temper, 0.0};
  file.least_sigma = {fixes_.back().least_sigma, plan_.least_sigma, 0.0};
  file.ray_depth = room.trace.max_depth;
  file.transmission = room.trace.transmission;
  file.access_points = calibrated_access_points(plan_, methods.front().calibration, results_);
  file.surfaces = calibrated_surfaces(room);
  file.parameters = methods.front().calibration.parameters;
  if (auto written =
          write_site(site_,
                     to_toml(file),
                     options_.out,
                     refined ? refined_scene(*room.scene) : std::map<std::string, std::string>());
      !written) {
    return written;
  }
  const CalibrationReport report = report_of(methods, file);
  const fs::path out = options_.out;
  if (auto json = write_file(out / "report.json", to_json(report).dump(2) + "\n"); !json) {
    return json;
  }
  if (auto html = write_file(out / "report.html", to_html(report)); !html) {
    return html;
  }
  if (!options_.quiet) {
    std::vector<AccessPointUse> used;
    for (const AccessPointResult& result : results_) {
      used.push_back({result.index, result.fit.samples_used});
    }
    print_summary(report, used);
  }
  return {};
}

// Where it was interrupted, says what there is and ends by the signal, as a script must know.
void Calibration::end(const std::vector<CalibrationMethodResult>& methods) const {
  const CalibrationMethodResult& written = methods.front();
  const bool resumes = written.calibration.interrupted && can_resume() && !unkept_;
  if (!resumes) {
    std::error_code none;
    fs::remove(checkpoint(), none);
  }
  if (!StopSignal::requested()) {
    return;
  }
  const bool compared =
      !options_.compare || (methods.size() == 2 && !methods.back().calibration.interrupted);
  std::fprintf(stderr,
               "interrupted: %s holds the %s%s\n",
               options_.out.c_str(),
               written.calibration.interrupted ? "last good state" : "whole calibration",
               resumes     ? "; --resume goes on"
               : !compared ? ", without the comparison"
                           : "");
  std::signal(SIGINT, SIG_DFL);
  std::raise(SIGINT);
}

Expected<void> Calibration::run() {
  line_.begin("reading the recordings");
  if (auto measured = measure(); !measured) {
    return measured;
  }
  const auto held = draw_holdout(inputs_.points.size(), options_.holdout, options_.seed);
  CombinedSurvey survey = combine_survey(plan_, held, options_.points, inputs_);
  points_ = std::move(survey.points);
  line_.begin("comparing points and recordings");
  if (auto refused = refuse(); !refused) {
    return refused;
  }
  line_.begin("fitting chain gains");
  if (auto fitted = fit_gains(survey.first_refusal); !fitted) {
    return fitted;
  }
  StopSignal::install_once();
  if (auto prepared = prepare_output(options_.out, options_.force || options_.resume); !prepared) {
    return prepared;
  }
  std::vector<CalibrationMethodResult> methods;
  std::vector<std::string> names{options_.method};
  if (options_.compare) {
    names.emplace_back(options_.method == "paper" ? "joint" : "paper");
  }
  for (const std::string& name : names) {
    auto result = calibrate(name);
    if (!result) {
      return tl::make_unexpected(std::move(result.error()));
    }
    methods.push_back(*std::move(result));
    if (!go_on()) {
      break;
    }
  }
  // In the calibrated room a point that was surveyed wrongly stands out; under the plan few do.
  for (const PointRefusal& odd :
       misfitting_points(plan_, methods.front().calibration.points, &PointFit::after)) {
    inputs_.refused.push_back(
        {place_of(odd.point), odd.reason + " (after the calibration; used all the same)"});
  }
  line_.begin("fitting the errors of the model");
  const RoomModel& room = methods.front().calibration.room;
  if (auto fitted = fit_errors(methods.front()); !fitted) {
    return fitted;
  }
  line_.begin("locating the points held out");
  if (auto fitted = fit_certainty(room); !fitted) {
    return fitted;
  }
  line_.clear();
  if (auto written = write(methods); !written) {
    return written;
  }
  end(methods);
  return {};
}

}  // namespace

Expected<void> run_calibration(const CalibrateArguments& arguments) {
  return Calibration(arguments).run();
}

}  // namespace rayloc::cli
