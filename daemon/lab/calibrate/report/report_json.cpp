#include <cmath>
#include <utility>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/lab/calibrate/report/expectation.h"
#include "daemon/lab/calibrate/report/fit_summary.h"
#include "daemon/lab/calibrate/report/parameter_change.h"
#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json heldout_json(const CalibrationReport& report, const RoomCalibration& calibration) {
  Json all = Json::object();
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    const FitSummary fit = summarize_fit(report, calibration, ap);
    Json& one = all[report.access_points[ap]];
    one["before"] = fit.before ? Json(fit.before->median) : Json();
    one["after"] = fit.after ? Json(fit.after->median) : Json();
    if (fit.placed) {
      one["after_survey_fitted"] = fit.placed->median;
    }
    one["points"] = fit.points;
    for (const auto& [name, summary] :
         {std::pair("before", fit.before), std::pair("after", fit.after)}) {
      one[std::string("mean_") + name] = summary ? Json(summary->mean) : Json();
      one[std::string("quartiles_") + name] =
          summary ? Json{summary->lower_quartile, summary->upper_quartile} : Json();
    }
  }
  return all;
}

Json written_heldout_json(const CalibrationReport& report) {
  Json all = heldout_json(report, report.methods.front().calibration);
  for (std::size_t ap = 0; ap < report.access_points.size(); ++ap) {
    const auto located = summarize_located(report, ap);
    Json& one = all[report.access_points[ap]];
    one["after_as_located"] = located ? Json(located->median) : Json();
    one["quartiles_after_as_located"] =
        located ? Json{located->lower_quartile, located->upper_quartile} : Json();
  }
  return all;
}

Json rays_json(const TraceOptions& rays) {
  return {{"max_depth", rays.max_depth},
          {"transmission", rays.transmission},
          {"softness_m", rays.softness}};
}

Json parameters_json(const std::vector<RoomParameter>& parameters) {
  Json all = Json::array();
  for (const RoomParameter& one : parameters) {
    all.push_back({{"name", to_string(one.id)},
                   {"value", one.value},
                   {"unit", one.unit},
                   {"prior", one.prior},
                   {"prior_sigma", one.prior_sigma > 0.0 ? Json(one.prior_sigma) : Json()},
                   {"sigma", one.sigma > 0.0 ? Json(one.sigma) : Json()}});
  }
  return all;
}

Json moved_json(const std::vector<RoomParameter>& parameters, double wavelength) {
  Json all = Json::array();
  for (const ParameterChange& change : parameter_changes(parameters, wavelength)) {
    Json one = {{"name", to_string(change.parameter.id)},
                {"by", change.by},
                {"unit", change.parameter.unit},
                {"prior_sigmas", change.prior_sigmas ? Json(*change.prior_sigmas) : Json()}};
    if (!change.caution.empty()) {
      one["caution"] = change.caution;
    }
    all.push_back(std::move(one));
  }
  return all;
}

Json point_fits_json(const CalibrationReport& report, const RoomCalibration& calibration) {
  Json all = Json::array();
  for (const PointFit& fit : calibration.points) {
    const Vec3d& at = report.positions.at(fit.point);
    all.push_back({{"position", {at.x, at.y, at.z}},
                   {"ap", report.access_points.at(fit.access_point)},
                   {"held_out", static_cast<bool>(report.held_out.at(fit.point))},
                   {"before", fit.before},
                   {"after", fit.after},
                   {"after_survey_fitted", fit.placed > 0.0 ? Json(fit.placed) : Json()}});
  }
  return all;
}

Json method_json(const CalibrationReport& report, const CalibrationMethodResult& result) {
  Json history = Json::array();
  for (const CalibrationStep& step : result.calibration.history) {
    history.push_back({{"stage", step.stage},
                       {"iteration", step.iteration},
                       {"loss", step.loss},
                       {"heldout", step.heldout}});
  }
  return {{"seconds", result.seconds},
          {"interrupted", result.calibration.interrupted},
          {"rays", rays_json(result.rays)},
          {"heldout", heldout_json(report, result.calibration)},
          {"parameters", result.calibration.parameters.size()},
          {"history", std::move(history)}};
}

Json fixes_json(const std::vector<HeldOutFixes>& fixes) {
  Json all = Json::array();
  for (const HeldOutFixes& one : fixes) {
    all.push_back({{"temper", one.likelihood_exponent},
                   {"least_sigma_m", one.sigma_floor},
                   {"dishonesty", one.dishonesty},
                   {"points", one.points},
                   {"fixes", one.fixes},
                   {"within_accuracy_95", one.within_accuracy},
                   {"log_score", one.log_score},
                   {"median_error_m", one.median_error_m ? Json(*one.median_error_m) : Json()}});
  }
  return all;
}

Json refused_json(const std::vector<RefusedInput>& refused) {
  Json all = Json::array();
  for (const RefusedInput& one : refused) {
    all.push_back({{"what", one.what}, {"reason", one.reason}});
  }
  return all;
}

Json mistakes_json(const std::vector<TriedMistake>& mistakes) {
  Json all = Json::array();
  for (const TriedMistake& one : mistakes) {
    all.push_back({{"what", one.what},
                   {"change", one.remedy},
                   {"correlation_as_stated", one.stated},
                   {"correlation", one.explained},
                   {"significance", one.significance}});
  }
  return all;
}

Json verdict_json(const CalibrationReport& report) {
  const CalibrationVerdict& verdict = report.verdict;
  return {{"success", verdict.is_success()},
          {"expectation", expectation(report)},
          {"advice", advice(report)},
          {"reasons", verdict.reasons},
          {"explained_by", mistakes_json(verdict.found)},
          {"tried", mistakes_json(verdict.tried)}};
}

}  // namespace

Json to_json(const CalibrationReport& report) {
  RAYLOC_CHECK(!report.methods.empty() && report.positions.size() == report.held_out.size());
  const CalibrationMethodResult& written = report.methods.front();
  Json methods = Json::object();
  for (const CalibrationMethodResult& result : report.methods) {
    methods[result.method] = method_json(report, result);
  }
  const double wavelength = kSpeedOfLight / report.before.grid.centre_hz;
  constexpr double kMebibyte = 1024.0 * 1024.0;
  return {{"method", written.method},
          {"verdict", verdict_json(report)},
          {"site", report.site},
          {"calibration_id", report.calibration_id},
          {"seed", report.seed},
          {"holdout", report.holdout},
          {"survey_error_m", report.survey_error},
          {"survey_error_is", report.survey_error_is},
          {"points", report.positions.size()},
          {"seconds", written.seconds},
          {"peak_memory_mib",
           report.peak_memory_bytes > 0
               ? Json(static_cast<double>(report.peak_memory_bytes) / kMebibyte)
               : Json()},
          {"heldout_is",
           "squared normalised correlation of measured and expected CSI at the points held out: "
           "before and after are medians, with the rays of the method; after_as_located is that of "
           "the site as written, with the rays and the model of a fix"},
          {"rays_as_located", rays_json(written.calibration.room.trace)},
          {"heldout", written_heldout_json(report)},
          {"heldout_fixes", fixes_json(report.fixes)},
          {"parameters", parameters_json(written.calibration.parameters)},
          {"moved", moved_json(written.calibration.parameters, wavelength)},
          {"refused", refused_json(report.refused)},
          {"methods", std::move(methods)},
          {"fits", point_fits_json(report, written.calibration)}};
}

}  // namespace rayloc
