#include "daemon/pipeline/device/chain_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/pipeline/device/chain_record_json.h"
#include "daemon/site/model/site_copy.h"
#include "engine/chains/chain_record.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;  // a count, of the versions of the file
constexpr std::string_view kLearning = "learning";
constexpr std::string_view kLearned = "learned";
constexpr const char* kEvidence = "evidence";

Json to_json(const ChainState& state, const RoomAccessPoint& ap) {
  Json factors = Json::array();
  for (const std::complex<double>& factor : state.factors.factor) {
    factors.push_back({factor.real(), factor.imag()});
  }
  Json json = {{"id", ap.id},
               {"chains", state.knowledge == ChainKnowledge::kLearned ? kLearned : kLearning},
               {"cores", ap.rx_chains},
               {"factor", std::move(factors)},
               {"phase_sigma_rad", state.factors.sigma},
               {"level_sigma", state.factors.log_gain_sigma},
               {"since_ns", state.since.time_since_epoch().count()},
               {"bursts", state.bursts}};
  if (state.record != nullptr) {
    json[kEvidence] = to_json(*state.record);
  }
  return json;
}

// `place` leads to `json`.
Expected<ChainState> from_json(const Json& json,
                               const std::string& place,
                               std::size_t access_point) {
  ChainState state;
  state.access_point = access_point;
  state.knowledge = json.at("chains").get<std::string>() == kLearned ? ChainKnowledge::kLearned
                                                                     : ChainKnowledge::kLearning;
  for (const Json& factor : json.at("factor")) {
    state.factors.factor.emplace_back(factor.at(0).get<double>(), factor.at(1).get<double>());
  }
  state.factors.sigma = json.at("phase_sigma_rad").get<std::vector<double>>();
  state.factors.log_gain_sigma = json.at("level_sigma").get<std::vector<double>>();
  const auto since = chain_time_from_json(json.at("since_ns"), place + ".since_ns");
  RAYLOC_TRY(since);
  state.since = *since;
  const auto bursts = chain_count_from_json(json.at("bursts"), place + ".bursts");
  RAYLOC_TRY(bursts);
  state.bursts = *bursts;
  return state;
}

bool is_sigma(double value) { return value >= 0.0 && value <= kMaxChainSigma; }

bool is_usable(const ChainState& state, std::size_t chains) {
  const auto& factor = state.factors.factor;
  const auto& sigma = state.factors.sigma;
  const auto& level_sigma = state.factors.log_gain_sigma;
  return factor.size() == chains && sigma.size() == chains && level_sigma.size() == chains &&
         std::all_of(sigma.begin(), sigma.end(), is_sigma) &&
         std::all_of(level_sigma.begin(), level_sigma.end(), is_sigma) &&
         std::all_of(factor.begin(), factor.end(), [](const auto& value) {
           return std::isfinite(std::abs(value)) && std::abs(value) > 0.0;
         });
}

Expected<std::vector<ChainState>> states_of(const Json& json, const RoomModel& room) {
  std::vector<ChainState> states;
  if (json.at("format").get<int>() != kFormat ||
      json.at("calibration").get<std::string>() != room.calibration_id) {
    return states;
  }
  const Json& all = json.at("access_points");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Json& one = all[i];
    for (std::size_t a = 0; a < room.access_points.size(); ++a) {
      const RoomAccessPoint& ap = room.access_points[a];
      if (ap.id != one.at("id").get<std::string>() ||
          ap.rx_chains != one.at("cores").get<std::vector<std::uint8_t>>()) {
        continue;
      }
      const std::string place = "access_points[" + std::to_string(i) + "]";
      auto read = from_json(one, place, a);
      RAYLOC_TRY(read);
      ChainState& state = *read;
      if (!is_usable(state, ap.rx_chains.size())) {
        continue;
      }
      if (state.knowledge == ChainKnowledge::kLearning && one.contains(kEvidence)) {
        auto record = record_from_json(one[kEvidence], place + "." + kEvidence, room, a);
        RAYLOC_TRY(record);
        state.record = std::make_shared<const ChainRecord>(*std::move(record));
      }
      states.push_back(std::move(state));
    }
  }
  return states;
}

}  // namespace

Expected<std::vector<ChainState>> read_chain_file(const fs::path& file, const RoomModel& room) {
  std::ifstream in(file);
  if (!in) {
    return std::vector<ChainState>();
  }
  try {
    auto states = states_of(Json::parse(in), room);
    if (!states) {
      return bad_input(file.string() + ": " + states.error().message);
    }
    return states;
  } catch (const nlohmann::json::exception& error) {
    return bad_input(file.string() + " is broken: " + error.what());
  }
}

Expected<void> write_chain_file(const fs::path& file,
                                const std::vector<ChainState>& states,
                                const RoomModel& room) {
  Json all = Json::array();
  for (const ChainState& state : states) {
    if (state.knowledge != ChainKnowledge::kAsCalibrated) {
      all.push_back(to_json(state, room.access_points[state.access_point]));
    }
  }
  const Json json = {
      {"format", kFormat}, {"calibration", room.calibration_id}, {"access_points", std::move(all)}};
  return write_file(file, json.dump(2) + "\n");
}

}  // namespace rayloc
