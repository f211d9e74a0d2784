#include "daemon/lab/experiment/condition_store.h"

#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/base/content_hash.h"
#include "engine/paper/settings.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Hash of all inputs of the result.
std::string hash_of(const Condition& condition, std::uint64_t seed) {
  ContentHash hash;
  hash.add(seed);
  hash.add(content(condition.room));
  for (const ConditionKey& key : condition_keys()) {
    hash.add(condition_text(condition, key.key));
  }
  for (const paper::Setting& setting : paper::settings()) {
    hash.add(condition_text(condition, "paper." + std::string(setting.key)));
  }
  return hash.text();
}

Json number(double value) { return value < PointResult::kMissed ? Json(value) : Json(nullptr); }
double number(const Json& value) {
  return value.is_null() ? PointResult::kMissed : value.get<double>();
}

std::string to_text(const ConditionResult& result) {
  Json points = Json::array();
  for (const PointResult& point : result.points) {
    points.push_back({number(point.error),
                      point.is_uncertainty_stated,
                      number(point.best_of_5),
                      number(point.region),
                      point.normalized ? Json(*point.normalized) : Json(nullptr)});
  }
  const Json json = {{"refusal", result.refusal},
                     {"room_centre", result.room_centre},
                     {"points", std::move(points)}};
  return json.dump() + "\n";
}

std::optional<ConditionResult> from_text(const std::string& text, const Condition& condition) {
  const Json json = Json::parse(text, nullptr, false);
  ConditionResult result;
  result.condition = condition;
  try {
    result.refusal = json.at("refusal").get<std::string>();
    result.room_centre = json.at("room_centre").get<std::vector<double>>();
    for (const Json& one : json.at("points")) {
      PointResult& point = result.points.emplace_back();
      point.error = number(one.at(0));
      point.is_uncertainty_stated = one.at(1).get<bool>();
      point.best_of_5 = number(one.at(2));
      point.region = number(one.at(3));
      if (!one.at(4).is_null()) {
        point.normalized = one.at(4).get<double>();
      }
    }
  } catch (const Json::exception&) {
    return std::nullopt;
  }
  return result.points.size() == result.room_centre.size() ? std::optional(std::move(result))
                                                           : std::nullopt;
}

}  // namespace

ConditionStore condition_store(const fs::path& directory, bool may_load) {
  const fs::path folder = directory / "conditions";
  const auto file_of = [folder](const Condition& condition, std::uint64_t seed) {
    return folder / (hash_of(condition, seed) + ".json");
  };
  ConditionStore store;
  if (may_load) {
    store.load = [file_of](const Condition& condition, std::uint64_t seed) {
      return from_text(content(file_of(condition, seed)), condition);
    };
  }
  store.save = [folder, file_of](const ConditionResult& result, std::uint64_t seed) {
    std::error_code ignored;  // a result that cannot be kept is recomputed
    fs::create_directories(folder, ignored);
    const fs::path file = file_of(result.condition, seed);
    const fs::path part = file.string() + ".part";
    std::ofstream(part, std::ios::binary) << to_text(result);
    fs::rename(part, file, ignored);
  };
  return store;
}

}  // namespace rayloc
