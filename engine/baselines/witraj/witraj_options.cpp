#include "engine/baselines/witraj/witraj_options.h"

#include <array>

namespace rayloc {
namespace {

// Two words: use of the access point with the least even rotation.
constexpr std::array kWorst = std::to_array<std::string_view>({"drop", "keep"});
// Two words: data that select the weaker antenna.
constexpr std::array kWeaker = std::to_array<std::string_view>({"access_point", "tone"});

std::span<const BaselineSetting> witraj_table() {
  // Each states its unit; chosen, except for the windows, which are the paper's (path_rate.h).
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"v_max", "greatest walking speed [m/s]; faster steps are cut", 1.5, 0.1, 10.0},
      {"sigma_v", "standard deviation of a path's rate [m/s]", 0.12, 1e-3, 10.0},
      {"rate_memory_s", "time for which the error of a path's rate persists [s]", 0.3, 1e-3, 10.0},
      {"worst", "the least even rotation of three access points", 0.0, 0.0, 0.0, false, kWorst},
      {"weaker", "data that select the weaker antenna", 0.0, 0.0, 0.0, false, kWeaker},
      {"start_sigma", "standard deviation of the start [m]", 0.1, 1e-3, 10.0},
  });
  return kTable;
}

}  // namespace

std::span<const BaselineSetting> witraj_settings() { return witraj_table(); }

WitrajOptions witraj_options(const BaselineValues& values) {
  WitrajOptions options;
  options.v_max = number_of(witraj_table(), values, "v_max");
  options.sigma_v = number_of(witraj_table(), values, "sigma_v");
  options.rate_memory_s = number_of(witraj_table(), values, "rate_memory_s");
  options.start_sigma = number_of(witraj_table(), values, "start_sigma");
  options.drops_worst = choice_of(witraj_table(), values, "worst") == 0;
  options.by_tone = choice_of(witraj_table(), values, "weaker") == 1;
  return options;
}

}  // namespace rayloc
