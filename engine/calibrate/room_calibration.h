// Inputs, progress reports and results of a room's calibration. Shared by the two methods:
// calibrate_jointly() (METHODS B4) and paper::calibrate() (METHODS A3).
#pragma once

#include <complex>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/fitted.h"
#include "engine/room/parameter_id.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A device on a surveyed point, as received by the access points.
struct CalibrationPoint {
  Vec3d position;         // [m], as surveyed
  bool held_out = false;  // never enters a fit; measures its quality
  // For each access point of the room: BurstObservation::h, [rx_chain][tone]; empty where the
  // access point received nothing.
  std::vector<std::vector<std::complex<double>>> h;
};

// A fitted number of the model.
struct RoomParameter : Fitted<double> {
  ParameterId id;
  std::string unit;          // "m", "rad", "S/m", "1"; for chains "dB" and "deg"
  double prior_sigma = 0.0;  // standard deviation of the prior; 0: no prior was used
};

// How well a point is explained: the squared normalised correlation |<h, h'>|^2 / (|h|^2 |h'|^2) of
// the measured and the expected [rx_chain][tone] array; gain, phase and delay of the burst
// profiled.
struct PointFit {
  std::size_t point = 0;
  std::size_t access_point = 0;
  double before = 0.0;  // floor plan and chain gains alone
  double after = 0.0;
  // As `after`, with the survey error of the point fitted too (joint method; else 0): the rest is
  // power that the model cannot represent, above all clutter and diffuse power.
  double placed = 0.0;
};

struct CalibrationStep {
  std::string stage;
  int iteration = 0;     // counted over all stages
  double loss = 0.0;     // of the points that are not held out; defined by the method
  double heldout = 0.0;  // median PointFit::after of the points held out so far
};

struct RoomCalibration {
  RoomModel room;  // scene, poses, gains and errors as calibrated
  std::vector<RoomParameter> parameters;
  std::vector<PointFit> points;  // every point and access point that was used or held out
  std::vector<CalibrationStep> history;
  // [m], of the points on each axis, as given or found (joint method; else 0).
  double survey_sigma = 0.0;
  bool interrupted = false;  // the caller requested a stop: the last good state
};

struct CalibrationProgress {
  CalibrationStep step;
  double share = 0.0;  // of the work done, 0 to 1
  std::size_t points = 0;
};

// Called between steps, from the thread of the caller; false asks to stop.
using CalibrationObserver = std::function<bool(const CalibrationProgress&)>;

}  // namespace rayloc
