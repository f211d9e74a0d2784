#include <sys/resource.h>

#include <cstdint>
#include <map>
#include <system_error>
#include <utility>

#include "daemon/lab/calibrate/calibrated_site.h"
#include "daemon/lab/calibrate/calibration_run.h"
#include "daemon/site/model/site_copy.h"
#include "engine/scene/scene_hash.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJsonReport = "report.json";
constexpr const char* kHtmlReport = "report.html";

std::uint64_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024U;  // [KiB] on Linux
}

// True if the folder holds only files of write_refusal(): a next run may overwrite these.
bool holds_reports_alone(const fs::path& folder) {
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const fs::path name = entry.path().filename();
    if (name != kJsonReport && name != kHtmlReport) {
      return false;
    }
  }
  return !failed;
}

// The parameters of the method and those that all methods fit.
std::vector<RoomParameter> all_parameters(const std::vector<CalibrationMethodResult>& methods,
                                          const CalibrationFile& file) {
  std::vector<RoomParameter> parameters = methods.front().calibration.parameters;
  for (const CalibratedAccessPoint& ap : file.access_points) {
    add_common_parameters(ap, parameters);
  }
  const auto assumed = [](Fitted<double> number) {  // these have no sigma
    number.sigma = 0.0;
    return number;
  };
  parameters.push_back({assumed(file.likelihood_exponent), parse_parameter_id("temper"), "1"});
  parameters.push_back({assumed(file.sigma_floor), parse_parameter_id("least_sigma"), "m"});
  return parameters;
}

}  // namespace

bool Calibration::may_replace() const {
  return options_.force || options_.resume || holds_reports_alone(options_.out);
}

CalibrationReport Calibration::report_of(
    const std::vector<CalibrationMethodResult>& methods) const {
  CalibrationReport report;
  report.site = site_.name;
  report.calibration_id = id_;
  report.holdout = options_.holdout;
  report.survey_error = survey_error_;
  report.survey_error_is = options_.survey_error                            ? "stated"
                           : methods.front().calibration.survey_sigma > 0.0 ? "found"
                                                                            : "assumed";
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
  for (const AccessPointResult& result : results_) {
    report.located.insert(report.located.end(), result.fits.begin(), result.fits.end());
  }
  report.fixes = fixes_;
  report.refused = inputs_.refused;
  report.verdict = verdict_;
  report.peak_memory_bytes = peak_memory();
  return report;
}

CalibrationFile Calibration::file_of(const std::vector<CalibrationMethodResult>& methods) const {
  const RoomModel& room = methods.front().calibration.room;
  CalibrationFile file;
  file.id = id_;
  file.method = methods.front().method;
  file.scene_hash = scene_hash(*room.scene);
  file.points_hash = inputs_.points_hash;
  file.likelihood_exponent = {fixes_.back().likelihood_exponent, plan_.likelihood_exponent, 0.0};
  file.sigma_floor = {fixes_.back().sigma_floor, plan_.sigma_floor, 0.0};
  file.ray_depth = room.trace.max_depth;
  file.transmission = room.trace.transmission;
  file.access_points = calibrated_access_points(plan_, methods.front().calibration, results_);
  file.surfaces = calibrated_surfaces(room);
  file.parameters = methods.front().calibration.parameters;
  return file;
}

Expected<void> Calibration::write_reports(const CalibrationReport& report) const {
  const fs::path out = options_.out;
  RAYLOC_TRY(write_file(out / kJsonReport, to_json(report).dump(2) + "\n"));
  return write_file(out / kHtmlReport, to_html(report));
}

// Writes only the reports. Removes the files of an interrupted run: it had the same inputs.
Expected<void> Calibration::write_refusal(const CalibrationReport& report) const {
  std::error_code none;
  for (const char* file : {"site.toml", "calibration.toml"}) {
    if (options_.resume) {
      fs::remove(fs::path(options_.out) / file, none);
    }
  }
  return write_reports(report);
}

// The site is written for a success, or if forced.
Expected<CalibrationResult> Calibration::write_site_and_reports(
    const std::vector<CalibrationMethodResult>& methods) {
  const CalibrationMethodResult& first = methods.front();
  const CalibrationFile file = file_of(methods);
  CalibrationResult result;
  result.report = report_of(methods);
  judge(result.report);
  result.report.methods.front().calibration.parameters = all_parameters(methods, file);
  result.outcome = outcome();
  for (const AccessPointResult& one : results_) {
    result.used.push_back({one.index, one.fit.samples_used});
  }
  result.is_site_written = verdict_.is_success() || options_.force;
  observer_.result(result);
  if (!result.is_site_written) {
    return write_refusal(result.report).map([&] { return std::move(result); });
  }
  if (!verdict_.is_success()) {
    observer_.verdict(verdict_);
  }
  const std::map<std::string, std::string> scene =
      first.method == "gains-only" ? std::map<std::string, std::string>()
                                   : refined_scene(*first.calibration.room.scene);
  RAYLOC_TRY(write_site(site_, to_toml(file), options_.out, scene));
  return write_reports(result.report).map([&] { return std::move(result); });
}

// Removes the checkpoint of a whole fit. After a stop, returns the state of the output.
std::optional<CalibrationInterruption> Calibration::end(
    const std::vector<CalibrationMethodResult>& methods) const {
  const CalibrationMethodResult& written = methods.front();
  const bool resumes = written.calibration.interrupted && can_resume() && !unkept_;
  if (!resumes) {
    std::error_code none;
    fs::remove(checkpoint(), none);
  }
  if (!options_.control.is_stop_requested()) {
    return std::nullopt;
  }
  const bool compared =
      !options_.compare || (methods.size() == 2 && !methods.back().calibration.interrupted);
  return CalibrationInterruption{!written.calibration.interrupted, resumes, compared};
}

}  // namespace rayloc
