// The calibration file: the results of `rayloc calibrate` for the access points of a site, as TOML:
// every number with its unit, its prior value and its standard deviation.
//
// For a device that the site states to have constant power (constant_power), each access point that
// received it at ten points or more has a table:
//   [[access_point.level]]
//   transmitter = "02:52:4c:00:00:01"
//   offset_db = 15.4     # received power by the receiver [dBm] minus the traced power [dB]
//   sigma_db = 1.9       # standard deviation between places, at least 0.5
//
// It is valid for the scene it was made with: `scene_hash` is compared when a room is loaded.
#pragma once

#include <complex>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/model/number_range.h"
#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct CalibratedAccessPoint {
  std::string id;
  std::size_t points = 0;     // number of surveyed points used
  Fitted<double> position_x;  // [m], added to the surveyed position
  Fitted<double> position_y;
  Fitted<double> position_z;
  Fitted<double> yaw_offset;  // [rad], added to the surveyed angles
  Fitted<double> pitch_offset;
  Fitted<double> roll_offset;
  Fitted<double> plan_tolerance;  // [m]
  Fitted<double> diffuse;
  Fitted<double> diffuse_exponent;
  Fitted<double> diffuse_decay{kDiffuseDecay, kDiffuseDecay, 0.0};  // [s]
  Fitted<double> noise;
  ChainGains gains;
  std::vector<double> gain_sigma;  // for each core [rad]
  std::vector<double> element_y;   // [m], for each core's antenna, added to its y in the array
  std::vector<TransmitterPower> powers = {};  // for transmitters of constant power
};

// Correction of all reflections by a surface, beyond its material (RoomModel::surface_correction).
struct CalibratedSurface {
  std::size_t index = 0;  // index in the scene
  std::complex<double> correction = 1.0;
};

struct CalibrationFile {
  std::string id;  // hash of the inputs
  std::string scene_hash;
  std::string points_hash;            // hash of the surveyed points
  std::string method = "gains-only";  // or "joint", "paper"
  Fitted<double> likelihood_exponent;
  Fitted<double> sigma_floor{0.01, 0.01, 0.0};  // [m]
  int ray_depth = kRayDepth;                    // RoomModel::trace
  bool transmission = false;
  std::vector<CalibratedAccessPoint> access_points;
  std::vector<CalibratedSurface> surfaces;  // surfaces whose correction is not 1
  std::vector<RoomParameter> parameters;    // all fitted parameters, for people
};

std::string to_toml(const CalibrationFile& calibration);

// Errors name file:line:column.
Expected<CalibrationFile> load_calibration_file(const std::filesystem::path& file);
Expected<CalibrationFile> parse_calibration_file(std::string_view text,
                                                 const std::filesystem::path& file);

// The numbers of a calibrated access point by name, for the file and for reports.
struct NamedValue {
  const char* name;
  const char* unit;
  Fitted<double> CalibratedAccessPoint::*value;
  NumberRange range = {};  // valid values in a file
};
const std::vector<NamedValue>& calibrated_values();

}  // namespace rayloc
