#include "daemon/cli/evaluate_report.h"

#include <cmath>
#include <optional>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

namespace rayloc::cli {
namespace {

using Json = nlohmann::ordered_json;

Json number(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

std::string interval(const ErrorStatistics& statistics, const std::string& name) {
  const auto found = statistics.ci95.find(name);
  return found == statistics.ci95.end()
             ? ""
             : fmt::format("   [{:.3f}, {:.3f}]", found->second[0], found->second[1]);
}

}  // namespace

std::string statistics_json(const ErrorStatistics& s) {
  Json json;
  json["n"] = s.n;
  json["missed"] = s.missed;
  json["median_m"] = number(s.median_m);
  json["mean_m"] = number(s.mean_m);
  json["rmse_m"] = number(s.rmse_m);
  json["located_mean_m"] = number(s.located_mean_m);
  json["located_rmse_m"] = number(s.located_rmse_m);
  json["cep50_m"] = number(s.cep50_m);
  json["cep90_m"] = number(s.cep90_m);
  json["cep95_m"] = number(s.cep95_m);
  json["below_0_5"] = s.below_0_5;
  json["below_1"] = s.below_1;
  json["coverage_50"] = s.coverage_50;
  json["coverage_95"] = s.coverage_95;
  json["anees"] = number(s.anees);
  json["best_of_5_median_m"] = number(s.best_of_5_median_m);
  json["room_centre_median_m"] = number(s.room_centre_median_m);
  json["fingerprint_median_m"] = nullptr;
  Json& intervals = json["ci95"] = Json::object();
  for (const auto& [name, bounds] : s.ci95) {
    intervals[name] = {number(bounds[0]), number(bounds[1])};
  }
  return json.dump() + "\n";
}

std::string statistics_table(const ErrorStatistics& s) {
  std::string table = fmt::format("located              {:>9} of {}\n", s.n - s.missed, s.n);
  const auto row =
      [&](const char* label, std::optional<double> value, const char* unit, const char* name) {
        if (value) {
          table += fmt::format("{:<20} {:>9.3f} {:<2}{}\n", label, *value, unit, interval(s, name));
        }
      };
  table += fmt::format("{:<20} {:>9}      {}\n", "horizontal error", "", "95 % interval");
  row("median (CEP50)", s.median_m, "m", "median_m");
  row("mean", s.mean_m, "m", "mean_m");
  row("RMSE", s.rmse_m, "m", "rmse_m");
  if (s.missed != 0) {
    row("mean, located", s.located_mean_m, "m", "");
    row("RMSE, located", s.located_rmse_m, "m", "");
  }
  row("CEP90", s.cep90_m, "m", "cep90_m");
  row("CEP95", s.cep95_m, "m", "cep95_m");
  row("below 0.5 m", s.below_0_5, "", "below_0_5");
  row("below 1 m", s.below_1, "", "below_1");
  row("in 50 % region", s.coverage_50, "", "coverage_50");
  row("in 95 % region", s.coverage_95, "", "coverage_95");
  row("ANEES (1: right)", s.anees, "", "");
  row("best of 5, median", s.best_of_5_median_m, "m", "best_of_5_median_m");
  row("room centre, median", s.room_centre_median_m, "m", "");
  return table;
}

}  // namespace rayloc::cli
