// Options of WiTraj.
#pragma once

#include <span>

#include "engine/baselines/settings.h"

namespace rayloc {

struct WitrajOptions {
  double v_max = 1.5;            // [m/s], of a walking person
  double least_rate_hz = 182.0;  // frames/s: five in the shorter window
  double sigma_v = 0.12;         // [m/s], of a path's rate
  double rate_memory_s = 0.3;    // [s], correlation time of its error
  double start_sigma = 0.1;      // [m], of the start
  bool drops_worst = true;       // of three access points, as published; otherwise all are used
  bool by_tone =
      false;  // the weaker antenna is chosen per tone (ours); otherwise for all, as published
  double accuracy_confidence = 0.95;
};

std::span<const BaselineSetting> witraj_settings();
WitrajOptions witraj_options(const BaselineValues& values);

}  // namespace rayloc
