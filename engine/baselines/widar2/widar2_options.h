// What Widar2.0 can be told.
#pragma once

#include <span>

#include "engine/baselines/motion/motion_sage.h"
#include "engine/baselines/settings.h"

namespace rayloc {

struct Widar2Options {
  double v_max = 1.5;        // [m/s], of who walks: paths change twice as fast at most
  double window_s = 0.1;     // of one search for paths
  std::size_t windows = 6;   // among which the target's paths are linked
  double sigma_psi = 0.35;   // [rad], of a path's phase from antenna to antenna
  double rate_sigma = 0.15;  // [m/s], of a path's rate
  double body = 0.165;       // [m], about the axis of a person, from where the echo comes
  double grid = 0.05;        // [m], cells of the map
  double accuracy_confidence = 0.95;
  MotionSageOptions sage;

  // Frames in a second with which the fastest path turns by half between two.
  double least_rate_hz(double wavelength) const { return 4.0 * v_max / wavelength; }
};

std::span<const BaselineSetting> widar2_settings();
Widar2Options widar2_options(const BaselineValues& values);

}  // namespace rayloc
