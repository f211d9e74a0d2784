// Options of Widar2.0.
#pragma once

#include <span>

#include "engine/baselines/motion/motion_sage.h"
#include "engine/baselines/settings.h"

namespace rayloc {

struct Widar2Options {
  double v_max = 1.5;        // [m/s], of a walking person: paths change at most twice as fast
  double window_s = 0.1;     // [s], of one search for paths
  std::size_t windows = 6;   // windows over which the target's paths are linked
  double sigma_psi = 0.35;   // [rad], of a path's phase from antenna to antenna
  double rate_sigma = 0.15;  // [m/s], of a path's rate
  double body = 0.165;       // [m], origin of the echo about a person's axis
  double grid = 0.05;        // [m], cells of the map
  double accuracy_confidence = 0.95;
  MotionSageOptions sage;

  // Frames per second at which the fastest path's phase changes by half a cycle between two.
  double least_rate_hz(double wavelength) const { return 4.0 * v_max / wavelength; }
};

std::span<const BaselineSetting> widar2_settings();
Widar2Options widar2_options(const BaselineValues& values);

}  // namespace rayloc
