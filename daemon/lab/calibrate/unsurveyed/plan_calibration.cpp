#include "daemon/lab/calibrate/unsurveyed/plan_calibration.h"

#include <numbers>

#include "engine/base/content_hash.h"

namespace rayloc {
namespace {

// [rad], standard deviation of a uniform phase.
constexpr double kAnyPhase = std::numbers::pi / std::numbers::sqrt3;

Fitted<double> as_planned(double value) { return {value, value, 0.0}; }

CalibratedAccessPoint planned(const RoomAccessPoint& ap, const OfdmGrid& grid) {
  CalibratedAccessPoint stated;
  stated.id = ap.id;
  stated.plan_tolerance = as_planned(ap.error.plan_tolerance);
  stated.diffuse = as_planned(ap.error.diffuse);
  stated.diffuse_exponent = as_planned(ap.error.diffuse_exponent);
  stated.diffuse_decay = as_planned(ap.error.diffuse_decay);
  stated.noise = as_planned(ap.error.noise);
  stated.gains.grid = grid;
  stated.gains.rx_chains = ap.rx_chains;
  stated.gains.gain.assign(ap.rx_chains.size() * grid.size(), 1.0);
  stated.gain_sigma.assign(ap.rx_chains.size(), kAnyPhase);
  stated.gain_sigma.front() = 0.0;  // reference chain of the others
  stated.element_y.assign(ap.array.element_offset.size(), 0.0);
  return stated;
}

}  // namespace

CalibrationFile plan_calibration(const RoomModel& plan) {
  CalibrationFile calibration;
  ContentHash content;
  content.add("plan");
  content.add(plan.scene_hash);
  calibration.id = content.text();
  calibration.scene_hash = plan.scene_hash;
  calibration.method = "unsurveyed";
  calibration.likelihood_exponent = as_planned(plan.likelihood_exponent);
  calibration.sigma_floor = as_planned(plan.sigma_floor);
  calibration.ray_depth = plan.trace.max_depth;
  calibration.transmission = plan.trace.transmission;
  for (const RoomAccessPoint& ap : plan.access_points) {
    calibration.access_points.push_back(planned(ap, plan.grid));
  }
  return calibration;
}

}  // namespace rayloc
