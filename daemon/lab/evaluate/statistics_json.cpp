#include "daemon/lab/evaluate/statistics_json.h"

#include <cmath>
#include <optional>

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json json_number(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

}  // namespace

nlohmann::ordered_json to_json(const ErrorStatistics& s) {
  Json json;
  json["n"] = s.n;
  json["missed"] = s.missed;
  json["median_m"] = json_number(s.median_m);
  json["mean_m"] = json_number(s.mean_m);
  json["rmse_m"] = json_number(s.rmse_m);
  json["located_mean_m"] = json_number(s.located_mean_m);
  json["located_rmse_m"] = json_number(s.located_rmse_m);
  json["cep50_m"] = json_number(s.cep50_m);
  json["cep90_m"] = json_number(s.cep90_m);
  json["cep95_m"] = json_number(s.cep95_m);
  json["below_0_5"] = s.below_0_5;
  json["below_1"] = s.below_1;
  json["coverage_50"] = json_number(s.coverage_50);
  json["coverage_95"] = json_number(s.coverage_95);
  json["anees"] = json_number(s.anees);
  json["best_of_5_median_m"] = json_number(s.best_of_5_median_m);
  json["room_centre_median_m"] = json_number(s.room_centre_median_m);
  json["fingerprint_median_m"] = json_number(s.fingerprint_median_m);
  Json& intervals = json["ci95"] = Json::object();
  for (const auto& [name, bounds] : s.ci95) {
    intervals[name] = {json_number(bounds[0]), json_number(bounds[1])};
  }
  return json;
}

}  // namespace rayloc
