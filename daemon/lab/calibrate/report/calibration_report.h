// CalibrationReport: results of a calibration, for programs (report.json)
// and for people (report.html). Several methods may have been tried on
// the same points; the result of the first one was written.
//
// Correlations are PointFit's: the share of the measured power that the model explains, 0 to 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/lab/calibrate/report/calibration_verdict.h"
#include "daemon/lab/calibrate/report/refused_input.h"
#include "engine/base/vec3.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct CalibrationMethodResult {
  std::string method;  // "joint", "paper", "gains-only"
  RoomCalibration calibration;
  double seconds = 0.0;  // wall clock
  TraceOptions rays;     // rays of the fit and of the comparison of its points
};

// Fixes of the held-out points, with the likelihood raised to one exponent
// (RoomModel::likelihood_exponent) and the RoomModel::sigma_floor that scores best with it.
struct HeldOutFixes {
  double likelihood_exponent = 0.0;
  double sigma_floor = 0.0;  // [m]
  std::size_t points = 0;    // held out and observed
  std::size_t fixes = 0;
  std::size_t within_accuracy = 0;       // truths within the stated 95 % radius
  std::optional<double> median_error_m;  // horizontal; empty without a fix
  // Mean logarithm of the density stated at the truth [1/m^2], and the deviation of the stated
  // regions from calibrated ones (TemperingExponent). Not a number without points.
  double log_score = std::numeric_limits<double>::quiet_NaN();
  double dishonesty = std::numeric_limits<double>::quiet_NaN();
};

struct CalibrationReport {
  std::string site;
  std::string calibration_id;
  double holdout = 0.0;                    // share of the points
  double survey_error = 0.0;               // [m]
  std::string survey_error_is = "stated";  // "stated", "found" by the fit, or "assumed"
  std::uint64_t seed = 0;
  std::vector<std::string> access_points;  // by PointFit::access_point
  std::vector<Vec3d> positions;            // [m], by CalibrationPoint
  std::vector<bool> held_out;              // by CalibrationPoint
  RoomModel before;                        // floor plan and survey
  std::vector<CalibrationMethodResult> methods;
  // PointFit::after in the written site, with the rays and the errors of a fix.
  std::vector<PointFit> located;
  std::vector<HeldOutFixes> fixes;  // by the first method; the last was taken
  std::vector<RefusedInput> refused;
  CalibrationVerdict verdict;
  std::uint64_t peak_memory_bytes = 0;  // of the process; 0: unknown
};

// Keys as in INTERFACE 3.3 and daemon/lab/calibrate/REPORT.md. REQUIRES:
// at least one method; `positions` and `held_out` of equal length.
// The indices of PointFit are valid in them and in `access_points`.
nlohmann::ordered_json to_json(const CalibrationReport& report);

// One page with embedded pictures: no script, no external resources, light or dark by the reader's
// preference; well-formed XML. REQUIRES: as above, and report.before.scene.
std::string to_html(const CalibrationReport& report);

}  // namespace rayloc
