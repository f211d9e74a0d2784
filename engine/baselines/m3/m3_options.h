// Options of M3.
#pragma once

#include <cstddef>
#include <span>

#include "engine/baselines/settings.h"

namespace rayloc {

struct M3Options {
  std::size_t paths = 5;
  double least_amplitude = 0.15;  // relative to the strongest path; weaker ones are dropped
  double sigma_u = 0.05;          // of the first path's sine
  double sigma_u_later = 0.08;    // of the sines of later paths
  double known = 0.9;             // probability that a later path is from a known reflector
  double grid = 0.05;             // [m]
  double accuracy_confidence = 0.95;
};

std::span<const BaselineSetting> m3_settings();
// The options in `values`, and defaults for all others.
M3Options m3_options(const BaselineValues& values);

}  // namespace rayloc
