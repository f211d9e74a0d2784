#include "engine/baselines/spotfi/spotfi_options.h"

#include <array>

#include "engine/baselines/paths/path_count.h"

namespace rayloc {
namespace {

// Three words, in the order of SpotfiRange.
constexpr std::array kRanges = std::to_array<std::string_view>({"level", "none", "room"});

std::span<const BaselineSetting> spotfi_table() {
  // Each states its unit; defaults are the paper's, or measured, or chosen (see the study).
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"frames", "most frames of a burst at an access point", 10.0, 1.0, 64.0, true},
      {"clusters", "clusters of the paths of a burst", 5.0, 1.0, 20.0, true},
      {"sigma_psi",
       "standard deviation of a direct path's phase from antenna to antenna [rad], where none was "
       "learned",
       0.45,
       0.01,
       3.0},
      {"outliers",
       "share of bursts whose direct path is another, where none was learned",
       0.15,
       0.0,
       0.9},
      {"grid_m", "cells of the map [m]", 0.05, 0.01, 1.0},
      {"w_share", "weight of a cluster's share in the likelihood of being direct", 1.0, 0.0, 1e3},
      {"w_psi", "weight of a cluster's deviation in phase [1/half turn]", 10.0, 0.0, 1e3},
      {"w_tau", "weight of a cluster's deviation in delay [1/100 ns]", 10.0, 0.0, 1e3},
      {"w_soon", "weight of a cluster's delay [1/100 ns]", 1.0, 0.0, 1e3},
      {"rank", "rule for the number of paths", 0.0, 0.0, 0.0, false, path_count_rule_names()},
      {"range", "source of the distance", 0.0, 0.0, 0.0, false, kRanges},
  });
  return kTable;
}

}  // namespace

std::span<const BaselineSetting> spotfi_settings() { return spotfi_table(); }

SpotfiOptions spotfi_options(const BaselineValues& values) {
  const auto number = [&](std::string_view key) { return number_of(spotfi_table(), values, key); };
  SpotfiOptions options;
  options.path.frames = static_cast<std::size_t>(number("frames"));
  options.path.clusters = static_cast<std::size_t>(number("clusters"));
  options.path.count = static_cast<PathCountRule>(choice_of(spotfi_table(), values, "rank"));
  options.path.w_share = number("w_share");
  options.path.w_psi = number("w_psi");
  options.path.w_tau = number("w_tau");
  options.path.w_soon = number("w_soon");
  options.sigma_psi = number("sigma_psi");
  options.outliers = number("outliers");
  options.grid = number("grid_m");
  options.range = static_cast<SpotfiRange>(choice_of(spotfi_table(), values, "range"));
  return options;
}

}  // namespace rayloc
