#include "daemon/lab/calibrate/calibration_run.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include "daemon/lab/calibrate/calibrated_site.h"
#include "daemon/lab/calibrate/calibration_points.h"
#include "daemon/lab/calibrate/dead_chain_check.h"
#include "daemon/lab/calibrate/holdout.h"
#include "daemon/lab/calibrate/inputs_hash.h"
#include "daemon/lab/calibrate/power_offset_stage.h"
#include "daemon/site/model/room_match.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "engine/calibrate/check/input_check.h"
#include "engine/calibrate/joint/joint_calibration.h"
#include "engine/calibrate/joint/multi_start.h"
#include "engine/paper/calibration.h"

namespace rayloc {
namespace {

constexpr const char* kOldReference =
    "is of another calibration and left out: record the empty room again (rayloc reference)";

}  // namespace

// Checks what would otherwise fail after minutes.
Expected<void> Calibration::check_site() {
  if (site_.calibration_file) {
    return make_error(ErrorKind::kConfiguration,
                      options_.site +
                          ": is calibrated already; give the site as it was surveyed, from which "
                          "the priors count. After a power cycle --rechain is enough. To start "
                          "from the scene of this one all the same, take [calibration] and "
                          "[reference] out of a copy of its site.toml");
  }
  return check_output(options_.out, site_.directory, may_replace());
}

Expected<void> Calibration::measure() {
  auto site = load_site(options_.site);
  RAYLOC_TRY(site);
  site_ = *std::move(site);
  RAYLOC_TRY(check_site());
  const auto captures =
      resolve_captures(options_.captures, access_point_ids(site_), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  auto room = load_room_model(site_);
  RAYLOC_TRY(room);
  plan_ = *std::move(room);
  for (const std::string& warning : room_warnings(*plan_.scene, site_)) {
    observer_.warn(warning);
  }
  note_scene(*plan_.scene, observer_);
  auto inputs = read_calibration_inputs(
      with_bounds(site_, plan_), *captures, options_.points, options_.time_offset);
  RAYLOC_TRY(inputs);
  inputs_ = *std::move(inputs);
  for (const std::string& note : inputs_.notes) {
    observer_.note(note);
  }
  if (site_.reference_file) {  // it holds the phases of another calibration
    inputs_.refused.push_back({site_.reference_file->filename().string(), kOldReference});
    site_.reference_file.reset();
    observer_.note(options_.site + ": [reference] " + kOldReference);
  }
  const CalibrationRequest request{
      options_.method, options_.holdout, options_.seed, options_.survey_error.value_or(0.0)};
  id_ = inputs_hash(site_, plan_, request, inputs_.content);
  return {};
}

// Checks for errors of survey and site, and for points that fit no position. A survey made
// otherwise than stated is bad data. A site that differs from the real installation leads to a
// report, and with --force the run continues.
Expected<void> Calibration::check_inputs() {
  const InputCheck check = check_calibration_inputs(plan_, points_);
  verdict_ = verdict_of_inputs(check);
  const bool of_survey =
      !check.found.empty() && check.found.front().kind != TriedMistake::Kind::kArray;
  if (of_survey && !options_.force) {
    return bad_input(options_.points + ": " + check.found.front().message);
  }
  if (!verdict_.is_success() && options_.force) {
    observer_.verdict(verdict_);
  }
  refuse_misfits(check);
  return {};
}

void Calibration::refuse_misfits(const InputCheck& check) {
  for (const PointRefusal& refusal : check.misfits) {
    inputs_.refused.push_back({place_of(refusal.point), refusal.reason});
    for (auto& h : points_[refusal.point].h) {
      h.clear();
    }
  }
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
      if (!first_refusal[a].empty()) {  // bandwidth or chains differ from the site
        result.error().message += "; the first that cannot: " + first_refusal[a];
      }
      return tl::make_unexpected(std::move(result.error()));
    }
    apply(result->train, start_.access_points[a]);
    gains_.push_back(*std::move(result));
  }
  return {};
}

// Saves the state from which --resume continues; a failure is reported once and ends nothing.
void Calibration::keep(const StoredCheckpoint& state) {
  const auto written = write_file(checkpoint(), to_json_text(state, id_));
  if (!written && !unkept_) {
    observer_.warn("warning: " + written.error().message +
                   "; after an interruption --resume cannot go on");
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
  joint.finds_survey = !options_.survey_error;
  joint.priors.survey = options_.survey_error.value_or(joint.priors.survey);
  StoredCheckpoint from;
  if (options_.resume) {
    auto loaded = load_checkpoint(checkpoint(), id_, start_, points_.size());
    RAYLOC_TRY(loaded);
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
  if (options_.control.is_stop_requested() && !is_stopping_) {
    is_stopping_ = true;
    observer_.note("interrupted: finishing with the last good state; once more ends at once");
    observer_.begin("finishing");
  }
  return !is_stopping_;
}

CalibrationMethodResult Calibration::gains_only() const {
  CalibrationMethodResult result{"gains-only", {}, 0.0, plan_.trace};
  result.calibration.room = plan_;
  for (const AccessPointResult& one : gains_) {
    result.calibration.points.insert(
        result.calibration.points.end(), one.fits.begin(), one.fits.end());
  }
  return result;
}

Expected<CalibrationMethodResult> Calibration::calibrate(const std::string& method) {
  if (method == "gains-only") {
    return gains_only();
  }
  CalibrationMethodResult result{method, {}, 0.0, plan_.trace};
  const paper::CalibrationOptions paper;
  result.rays = method == "paper"
                    ? TraceOptions{.max_depth = paper.max_depth, .softness = paper.softness}
                    : JointCalibrationOptions().trace;
  observer_.begin(method);
  const auto observer = [&](const CalibrationProgress& progress) {
    observer_.step(progress);
    return go_on();
  };
  const auto begin = std::chrono::steady_clock::now();
  auto calibration = method == "paper" ? paper::calibrate(start_, points_, paper, observer)
                                       : jointly(observer, result.seconds);
  RAYLOC_TRY(calibration);
  result.calibration = *std::move(calibration);
  count_yaw_from_survey(plan_, start_, result.calibration.parameters);
  if (method == "paper") {
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  return result;
}

// Fits the room model errors that the likelihood needs. The joint calibration estimates the arrays
// better than this stage, which uses fewer measurements.
Expected<void> Calibration::fit_errors(const CalibrationMethodResult& method) {
  const RoomModel& room = method.calibration.room;
  const ArrayFit array = method.method == "joint" ? ArrayFit::kHeld : ArrayFit::kFitted;
  for (const AccessPointResult& gains : gains_) {
    auto result = fit_access_point(room, gains.index, points_, survey_error_, array);
    RAYLOC_TRY(result);
    refuse_unreached(*result);
    results_.push_back(*std::move(result));
  }
  return {};
}

// Refuses points that were observed and have no fit.
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

// Observations at the held-out points, or at all points that were not refused.
std::vector<HeldOutPoint> Calibration::reference_points(bool all) const {
  std::vector<HeldOutPoint> points;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const auto& h = points_[p].h;
    const bool used = std::any_of(h.begin(), h.end(), [](const auto& one) { return !one.empty(); });
    if ((all ? used : points_[p].held_out) && !inputs_.points[p].frames.empty()) {
      points.push_back({points_[p].position, inputs_.points[p].frames});
    }
  }
  return points;
}

Expected<void> Calibration::fit_certainty(const RoomModel& room) {
  auto trained = std::make_shared<RoomModel>(room);
  for (AccessPointResult& result : results_) {
    result.powers = fit_power_offsets(site_, room, result, reference_points(true), inputs_.refused);
    apply(result.train, trained->access_points[result.index]);
    trained->access_points[result.index].powers = result.powers;
  }
  auto fixes = fit_certainty_of(std::move(trained), reference_points(false), survey_error_);
  RAYLOC_TRY(fixes);
  fixes_ = *std::move(fixes);
  return {};
}

// The first result is the one that is written.
Expected<std::vector<CalibrationMethodResult>> Calibration::calibrate_all() {
  std::vector<CalibrationMethodResult> methods;
  std::vector<std::string> names{options_.method};
  if (options_.compare) {
    names.emplace_back(options_.method == "paper" ? "joint" : "paper");
  }
  for (const std::string& name : names) {
    auto result = calibrate(name);
    RAYLOC_TRY(result);
    methods.push_back(*std::move(result));
    if (!go_on()) {
      break;
    }
  }
  return methods;
}

// Fits what the likelihood needs beside the room.
Expected<void> Calibration::fit_what_is_left(const std::vector<CalibrationMethodResult>& methods) {
  // In the calibrated room a wrongly surveyed point is an outlier; under the plan few are.
  for (const PointRefusal& odd :
       misfitting_points(plan_, methods.front().calibration.points, &PointFit::after)) {
    inputs_.refused.push_back(
        {place_of(odd.point), odd.reason + " (after the calibration; used all the same)"});
  }
  if (methods.front().calibration.survey_sigma > 0.0) {  // stated or estimated
    survey_error_ = methods.front().calibration.survey_sigma;
  }
  observer_.begin("fitting the errors of the model");
  RAYLOC_TRY(fit_errors(methods.front()));
  observer_.begin("locating the points held out");
  return fit_certainty(methods.front().calibration.room);
}

// If the fit has failed and no error was found, other carriers than the site's are tried as well:
// under the plan alone they are too inconclusive to be tried earlier.
void Calibration::judge(CalibrationReport& report) {
  judge_held_out(report, verdict_);
  if (!verdict_.is_success() && verdict_.found.empty()) {
    observer_.begin("trying other channels");
    add_carriers(try_carriers(plan_, points_), verdict_);
  }
  report.verdict = verdict_;
}

Expected<CalibrationResult> Calibration::run() {
  observer_.begin("reading the recordings");
  RAYLOC_TRY(measure());
  const auto held = draw_holdout(inputs_.points.size(), options_.holdout, options_.seed);
  CombinedSurvey survey = combine_survey(plan_, held, options_.points, inputs_);
  points_ = std::move(survey.points);
  if (const std::string dead = dead_chains_of(plan_, points_, inputs_); !dead.empty()) {
    if (!options_.force) {
      return bad_input(dead);
    }
    observer_.warn(dead);
  }
  observer_.begin("comparing points and recordings");
  RAYLOC_TRY(check_inputs());
  observer_.begin("fitting chain gains");
  RAYLOC_TRY(fit_gains(survey.first_refusal));
  if (options_.control.on_begin) {
    options_.control.on_begin();
  }
  RAYLOC_TRY(prepare_output(options_.out, may_replace()));
  if (!verdict_.is_success() && !options_.force) {
    CalibrationResult refused{
        CalibrationOutcome::kFails, report_of({gains_only()}), {}, false, std::nullopt};
    RAYLOC_TRY(write_refusal(refused.report));
    return refused;
  }
  const auto methods = calibrate_all();
  RAYLOC_TRY(methods);
  RAYLOC_TRY(fit_what_is_left(*methods));
  auto result = write_site_and_reports(*methods);
  if (result) {
    result->interruption = end(*methods);
  }
  return result;
}

Expected<CalibrationResult> run_calibration(const CalibrateArguments& arguments,
                                            const FitObserver& observer) {
  return Calibration(arguments, observer).run();
}

}  // namespace rayloc
