#include "daemon/lab/evaluate/evaluate_report.h"

#include <cmath>
#include <optional>

#include <spdlog/fmt/fmt.h>

#include "daemon/lab/evaluate/statistics_json.h"

namespace rayloc {
namespace {

// A value that misses made infinite has no number: it is printed as "missed" without a unit.
std::string figure_text(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "missed";
}

std::string interval(const ErrorStatistics& statistics, const std::string& name) {
  const auto found = statistics.ci95.find(name);
  return found == statistics.ci95.end()
             ? ""
             : fmt::format(
                   "   [{}, {}]", figure_text(found->second[0]), figure_text(found->second[1]));
}

}  // namespace

std::string statistics_json(const ErrorStatistics& s) { return to_json(s).dump() + "\n"; }

std::string statistics_table(const ErrorStatistics& s) {
  std::string table = fmt::format("located              {:>9} of {}\n", s.n - s.missed, s.n);
  const auto row =
      [&](const char* label, std::optional<double> value, const char* unit, const char* name) {
        if (value) {
          table += fmt::format("{:<20} {:>9} {:<2}{}\n",
                               label,
                               figure_text(*value),
                               std::isfinite(*value) ? unit : "",
                               interval(s, name));
        }
      };
  table += fmt::format("{:<20} {:>9}      {}\n", "horizontal error", "", "95 % interval");
  row("median (CEP50)", s.median_m, "m", "median_m");
  row("mean", s.mean_m, "m", "mean_m");
  row("RMSE", s.rmse_m, "m", "rmse_m");
  if (s.missed != 0) {
    row("mean, located", s.located_mean_m, "m", "located_mean_m");
    row("RMSE, located", s.located_rmse_m, "m", "located_rmse_m");
  }
  row("CEP90", s.cep90_m, "m", "cep90_m");
  row("CEP95", s.cep95_m, "m", "cep95_m");
  row("below 0.5 m", s.below_0_5, "", "below_0_5");
  row("below 1 m", s.below_1, "", "below_1");
  const auto stated =
      [&](const char* label, std::optional<double> value, const char* unit, const char* name) {
        if (value) {
          row(label, value, unit, name);
        } else {
          table += fmt::format("{:<20} {:>10}\n", label, "not stated");
        }
      };
  stated("in 50 % region", s.coverage_50, "", "coverage_50");
  stated("in 95 % region", s.coverage_95, "", "coverage_95");
  stated("ANEES (1: right)", s.anees, "", "anees");
  stated("best of 5, median", s.best_of_5_median_m, "m", "best_of_5_median_m");
  row("room centre, median", s.room_centre_median_m, "m", "room_centre_median_m");
  row("  skill against it", s.skill_room_centre, "", "skill_room_centre");
  row("fingerprint, median", s.fingerprint_median_m, "m", "fingerprint_median_m");
  row("  skill against it", s.skill_fingerprint, "", "skill_fingerprint");
  if (table.find("missed") != std::string::npos) {
    table += "missed: so many points have no position that the figure has no number\n";
  }
  return table;
}

}  // namespace rayloc
