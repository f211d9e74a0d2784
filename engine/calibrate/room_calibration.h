// What the calibration of a room starts from, how it tells its progress, and what it leaves. Shared
// by the two methods: calibrate_jointly() (METHODS B4) and calibrate_by_paper() (METHODS A3).
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

// A device on a surveyed point, as the access points heard it.
struct CalibrationPoint {
  Vec3d position;         // [m], as surveyed
  bool held_out = false;  // never enters a fit; says how good the fit is
  // Of each access point of the room: BurstObservation::h, [core][tone]; empty where the access
  // point heard nothing.
  std::vector<std::vector<std::complex<double>>> h;
};

// A number of the model that was fitted.
struct RoomParameter : Fitted<double> {
  ParameterId id;
  std::string unit;          // "m", "rad", "S/m", "1"; of chains "dB" and "deg"
  double prior_sigma = 0.0;  // how far the prior may be off; 0: nothing was assumed
};

// How well a point is explained: the squared normalised correlation |<h, h'>|^2 / (|h|^2 |h'|^2) of
// the measured and the expected [core][tone] array; gain, phase and delay of the burst profiled.
struct PointFit {
  std::size_t point = 0;
  std::size_t access_point = 0;
  double before = 0.0;  // floor plan and chain gains alone
  double after = 0.0;
  // As `after`, with the survey error of the point fitted too (joint method; else 0): the rest is
  // what the model cannot say, clutter and diffuse power above all.
  double placed = 0.0;
};

struct CalibrationStep {
  std::string stage;
  int iteration = 0;     // counted over all stages
  double loss = 0.0;     // of the points that are not held out; what it is depends on the method
  double heldout = 0.0;  // median PointFit::after of the points held out so far
};

struct RoomCalibration {
  RoomModel room;  // scene, poses, gains and errors as calibrated
  std::vector<RoomParameter> parameters;
  std::vector<PointFit> points;  // of every point and access point that was used or held out
  std::vector<CalibrationStep> history;
  // [m], of the points on each axis, as it was known or found (joint method; else 0).
  double survey_sigma = 0.0;
  bool interrupted = false;  // the caller asked to stop: the last good state
};

struct CalibrationProgress {
  CalibrationStep step;
  double share = 0.0;  // of the work done, 0 to 1
  std::size_t points = 0;
};

// Called between steps, from the thread of the caller; false asks to stop.
using CalibrationObserver = std::function<bool(const CalibrationProgress&)>;

}  // namespace rayloc
