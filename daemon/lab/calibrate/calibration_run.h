// Calibration: a run on a survey. calibration_run.cpp has the steps,
// calibration_output.cpp writes their results.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/access_point_stage.h"
#include "daemon/lab/calibrate/calibrate.h"
#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/lab/calibrate/checkpoint_file.h"
#include "daemon/lab/calibrate/fit_observer.h"
#include "daemon/lab/calibrate/held_out_fixes.h"
#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/site.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

class Calibration {
 public:
  // REQUIRES: `options` and `observer` outlive this object.
  Calibration(const CalibrateArguments& options, const FitObserver& observer)
      : options_(options),
        observer_(observer),
        survey_error_(options.survey_error.value_or(CalibrationPriors().survey)) {}

  Expected<CalibrationResult> run();

 private:
  Expected<void> check_site();
  Expected<void> measure();
  Expected<void> check_inputs();
  void refuse_misfits(const InputCheck& check);
  Expected<void> fit_gains(const std::vector<std::string>& first_refusal);
  CalibrationMethodResult gains_only() const;
  Expected<CalibrationMethodResult> calibrate(const std::string& method);
  Expected<std::vector<CalibrationMethodResult>> calibrate_all();
  Expected<RoomCalibration> jointly(const CalibrationObserver& observer, double& seconds);
  void keep(const StoredCheckpoint& state);
  bool go_on();
  bool can_resume() const { return options_.method == "joint"; }  // not by --compare
  std::optional<CalibrationInterruption> end(
      const std::vector<CalibrationMethodResult>& methods) const;
  Expected<void> fit_errors(const CalibrationMethodResult& method);
  void refuse_unreached(const AccessPointResult& result);
  std::vector<HeldOutPoint> reference_points(bool all) const;
  Expected<void> fit_certainty(const RoomModel& room);
  Expected<void> fit_what_is_left(const std::vector<CalibrationMethodResult>& methods);
  void judge(CalibrationReport& report);

  // calibration_output.cpp
  bool may_replace() const;
  CalibrationReport report_of(const std::vector<CalibrationMethodResult>& methods) const;
  CalibrationFile file_of(const std::vector<CalibrationMethodResult>& methods) const;
  Expected<CalibrationResult> write_site_and_reports(
      const std::vector<CalibrationMethodResult>& methods);
  Expected<void> write_reports(const CalibrationReport& report) const;
  Expected<void> write_refusal(const CalibrationReport& report) const;

  // "points.csv:17"
  std::string place_of(std::size_t point) const {
    return options_.points + ":" + std::to_string(inputs_.points[point].point.line);
  }
  std::filesystem::path checkpoint() const {
    return std::filesystem::path(options_.out) / kCheckpointFile;
  }
  CalibrationOutcome outcome() const {
    return verdict_.is_success() ? CalibrationOutcome::kExplains : CalibrationOutcome::kFails;
  }

  const CalibrateArguments& options_;
  const FitObserver& observer_;
  double survey_error_;  // [m], as stated, or assumed and then estimated
  Site site_;
  CalibrationInputs inputs_;
  RoomModel plan_;   // room as surveyed
  RoomModel start_;  // with the gains and the yaw fitted to the points not held out
  std::vector<CalibrationPoint> points_;
  CalibrationVerdict verdict_;
  std::vector<AccessPointResult> gains_;    // in the room of the plan
  std::vector<AccessPointResult> results_;  // in the calibrated room
  std::vector<HeldOutFixes> fixes_;
  std::string id_;            // hash of all inputs
  bool unkept_ = false;       // last state could not be written
  bool is_stopping_ = false;  // a stop was requested, and reported
};

}  // namespace rayloc
