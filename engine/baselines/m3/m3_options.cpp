#include "engine/baselines/m3/m3_options.h"

#include <array>

namespace rayloc {
namespace {

std::span<const BaselineSetting> m3_table() {
  // Each states its unit; the paper's values are not readable, these are chosen (see the study).
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"paths", "paths sought at an access point", 5.0, 1.0, 12.0, true},
      {"least_amplitude", "least amplitude of a path, share of the strongest", 0.15, 0.0, 1.0},
      {"sigma_u", "standard deviation of the first path's sine of azimuth", 0.05, 1e-3, 1.0},
      {"sigma_u_later", "standard deviation of a later path's sine of azimuth", 0.08, 1e-3, 1.0},
      {"known", "probability that a later path is of a known reflector", 0.9, 0.0, 0.999},
      {"grid_m", "cells of the map [m]", 0.05, 0.01, 1.0},
  });
  return kTable;
}

}  // namespace

std::span<const BaselineSetting> m3_settings() { return m3_table(); }

M3Options m3_options(const BaselineValues& values) {
  const auto number = [&](std::string_view key) { return number_of(m3_table(), values, key); };
  M3Options options;
  options.paths = static_cast<std::size_t>(number("paths"));
  options.least_amplitude = number("least_amplitude");
  options.sigma_u = number("sigma_u");
  options.sigma_u_later = number("sigma_u_later");
  options.known = number("known");
  options.grid = number("grid_m");
  return options;
}

}  // namespace rayloc
