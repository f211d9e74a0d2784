#include "engine/baselines/widar2/widar2_options.h"

#include <array>

namespace rayloc {
namespace {

std::span<const BaselineSetting> widar2_table() {
  // Each states its unit; the first three are the paper's, the others chosen or measured.
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"window_s", "duration of one search for paths [s]", 0.1, 0.02, 1.0},
      {"paths", "paths in a window", 5.0, 1.0, 20.0, true},
      {"windows", "windows among which the target's paths are linked", 6.0, 1.0, 30.0, true},
      {"v_max", "greatest walking speed [m/s]", 1.5, 0.1, 10.0},
      {"sigma_psi", "standard deviation of a path's phase between antennas [rad]", 0.35, 0.01, 3.0},
      {"sigma_v", "standard deviation of a path's rate [m/s]", 0.15, 1e-3, 10.0},
      {"body_m",
       "radius about the axis of a person at which the echo originates [m]; 0: a point",
       0.165,
       0.0,
       1.0},
      {"tau_step_ns", "step of the delays that are tried [ns]", 2.0, 0.1, 50.0},
      {"psi_points", "phases that are tried", 72.0, 4.0, 720.0, true},
      {"grid_m", "cells of the map [m]", 0.05, 0.01, 1.0},
  });
  return kTable;
}

}  // namespace

std::span<const BaselineSetting> widar2_settings() { return widar2_table(); }

Widar2Options widar2_options(const BaselineValues& values) {
  const auto number = [&](std::string_view key) { return number_of(widar2_table(), values, key); };
  Widar2Options options;
  options.window_s = number("window_s");
  options.windows = static_cast<std::size_t>(number("windows"));
  options.v_max = number("v_max");
  options.sigma_psi = number("sigma_psi");
  options.rate_sigma = number("sigma_v");
  options.body = number("body_m");
  options.grid = number("grid_m");
  options.sage.paths = static_cast<std::size_t>(number("paths"));
  options.sage.psi_points = static_cast<std::size_t>(number("psi_points"));
  options.sage.delay_step = 1e-9 * number("tau_step_ns");
  options.sage.most_rate = 2.0 * options.v_max;
  return options;
}

}  // namespace rayloc
