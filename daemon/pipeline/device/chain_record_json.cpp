#include "daemon/pipeline/device/chain_record_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/chains/chain_memory.h"
#include "engine/likelihood/rotated_likelihood.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;
using Value = std::complex<double>;

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr double kWeightStep = 0.1;  // [nat], chosen: far below the evidence of a burst
constexpr double kMaxWeight = 255.0;
constexpr double kMaxSum = 1e-6;  // deviation of the sum of probabilities from 1, of rounding
constexpr std::int64_t kMaxTime = 4'000'000'000'000'000'000;  // [ns], chosen: 127 years
constexpr double kMaxGain = 100.0;  // a ratio, chosen: 40 dB, more is no amplitude of a chain

template <typename T>
std::string encode(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) {
    std::memcpy(bytes.data(), values.data(), bytes.size());
  }
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < count ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

// Error: text that is not base64, or not of `count` values.
template <typename T>
Expected<std::vector<T>> decode(const Json& json, std::size_t count, const std::string& key) {
  const std::size_t size = count * sizeof(T);
  const auto text = json.is_string() ? json.get<std::string>() : std::string();
  if (text.size() != (size + 2) / 3 * 4) {
    return bad_input(key + " is not base64 text of " + std::to_string(count) + " values");
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool is_padding = text[i + k] == '=' && i + 4 == text.size();
      const std::size_t digit = is_padding ? 0 : kDigits.find(text[i + k]);
      if (digit == std::string_view::npos) {
        return bad_input(key + " is not base64 text");
      }
      group = group << 6U | static_cast<std::uint32_t>(digit);
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      bytes.push_back(static_cast<std::uint8_t>(group >> (16U - 8U * k) & 255U));
    }
  }
  std::vector<T> values(count);
  if (count > 0) {
    std::memcpy(values.data(), bytes.data(), size);
  }
  return values;
}

std::vector<std::uint8_t> quantised(const std::vector<float>& log_weight) {
  const double top = static_cast<double>(*std::max_element(log_weight.begin(), log_weight.end()));
  std::vector<std::uint8_t> weights;
  weights.reserve(log_weight.size());
  for (const float one : log_weight) {
    const double steps = std::round((top - static_cast<double>(one)) / kWeightStep);
    weights.push_back(static_cast<std::uint8_t>(std::min(steps, kMaxWeight)));
  }
  return weights;
}

Json burst_json(const ChainRecord::Burst& burst) {
  std::vector<float> parts;
  for (const Value& one : burst.h) {
    parts.push_back(static_cast<float>(one.real()));
    parts.push_back(static_cast<float>(one.imag()));
  }
  Json json = {{"time_ns", burst.time.time_since_epoch().count()},
               {"noise", burst.noise},
               {"gain", burst.gain},
               {"h", encode(parts)}};
  if (burst.place) {
    json["place"] = {burst.place->x, burst.place->y, burst.place->z};
  } else if (!burst.log_weight.empty()) {
    json["cells"] = burst.log_weight.size();
    json["weights"] = encode(quantised(burst.log_weight));
  }
  return json;
}

// Reads the evidence of one access point; `place` leads to it.
class RecordReader {
 public:
  RecordReader(const RoomModel& room, std::size_t access_point)
      : chains_(room.access_points[access_point].rx_chains.size()), tones_(room.grid.size()) {}

  Expected<ChainRecord> read(const Json& json, const std::string& place) const {
    if (chains_ < 2 || chains_ > kMaxChains) {
      return bad_input(place + ": chains of such a number are not learned");
    }
    auto record = counts_of(json, place);
    RAYLOC_TRY(record);
    auto belief = belief_of(json.at("belief"), place + ".belief");
    RAYLOC_TRY(belief);
    record->belief = *std::move(belief);
    auto gain = gain_of(json.at("gain"), place + ".gain");
    RAYLOC_TRY(gain);
    record->gain = *std::move(gain);
    auto favourite = favourite_of(json.at("favourite"), place + ".favourite");
    RAYLOC_TRY(favourite);
    record->favourite = *std::move(favourite);
    const Json& received = json.at("received");
    if (received.size() > ChainMemory::kMost || record->bursts < received.size()) {
      return bad_input(place + ".received has more than " + std::to_string(ChainMemory::kMost) +
                       " bursts, or more than .bursts");
    }
    for (std::size_t i = 0; i < received.size(); ++i) {
      auto burst = burst_of(received[i], place + ".received[" + std::to_string(i) + "]");
      RAYLOC_TRY(burst);
      record->received.push_back(*std::move(burst));
    }
    return record;
  }

 private:
  static bool is_gain(double gain) { return gain > 1.0 / kMaxGain && gain < kMaxGain; }

  static Expected<ChainRecord> counts_of(const Json& json, const std::string& place) {
    ChainRecord record;
    const std::array<std::pair<const char*, std::size_t ChainRecord::*>, 5> counts = {
        {{"learner", &ChainRecord::learner},
         {"learners", &ChainRecord::learners},
         {"bursts", &ChainRecord::bursts},
         {"bursts_needed", &ChainRecord::bursts_needed},
         {"unrefined", &ChainRecord::unrefined}}};
    for (const auto& [key, member] : counts) {
      const auto count = chain_count_from_json(json.at(key), place + "." + key);
      RAYLOC_TRY(count);
      record.*member = *count;
    }
    record.lead = json.at("lead").get<double>();
    record.phase_sigma = json.at("phase_sigma_rad").get<double>();
    if (!std::isfinite(record.lead)) {
      return bad_input(place + ".lead must be finite");
    }
    if (!(record.phase_sigma >= 0.0 && record.phase_sigma <= kMaxChainSigma)) {
      return bad_input(place + ".phase_sigma_rad must be 0 to 10");
    }
    return record;
  }

  Expected<std::vector<double>> belief_of(const Json& json, const std::string& key) const {
    auto belief = decode<double>(json, RotationGrid(chains_).size(), key);
    RAYLOC_TRY(belief);
    double sum = 0.0;
    bool is_probability = true;
    for (const double one : *belief) {
      is_probability = is_probability && one >= 0.0;  // false for a NaN
      sum += one;
    }
    if (!is_probability || !(std::abs(sum - 1.0) < kMaxSum)) {
      return bad_input(key + " is not a probability of each state");
    }
    return belief;
  }

  Expected<std::vector<double>> gain_of(const Json& json, const std::string& key) const {
    auto gain = json.get<std::vector<double>>();
    if (gain.size() != chains_ || !std::all_of(gain.begin(), gain.end(), is_gain)) {
      return bad_input(key + " is not one amplitude of each chain");
    }
    return gain;
  }

  Expected<std::vector<Value>> favourite_of(const Json& json, const std::string& key) const {
    std::vector<Value> favourite;
    for (const Json& one : json) {
      favourite.emplace_back(one.at(0).get<double>(), one.at(1).get<double>());
    }
    if ((!favourite.empty() && favourite.size() != chains_) ||
        !std::all_of(favourite.begin(), favourite.end(), [](const Value& one) {
          return is_gain(std::abs(one));
        })) {
      return bad_input(key + " is not one factor of each chain");
    }
    return favourite;
  }

  Expected<ChainRecord::Burst> burst_of(const Json& json, const std::string& place) const {
    ChainRecord::Burst burst;
    const auto time = chain_time_from_json(json.at("time_ns"), place + ".time_ns");
    RAYLOC_TRY(time);
    burst.time = *time;
    burst.noise = json.at("noise").get<double>();
    if (!(burst.noise >= 0.0 && burst.noise < 1.0)) {
      return bad_input(place + ".noise is not a share of the power");
    }
    auto gain = gain_of(json.at("gain"), place + ".gain");
    RAYLOC_TRY(gain);
    burst.gain = *std::move(gain);
    const auto parts = decode<float>(json.at("h"), 2 * chains_ * tones_, place + ".h");
    RAYLOC_TRY(parts);
    double power = 0.0;
    for (std::size_t i = 0; i < parts->size(); i += 2) {
      burst.h.emplace_back(static_cast<double>((*parts)[i]), static_cast<double>((*parts)[i + 1]));
      power += std::norm(burst.h.back());
    }
    if (!(std::isfinite(power) && power > 0.0)) {
      return bad_input(place + ".h has no power");
    }
    if (json.contains("place")) {
      const auto xyz = json["place"].get<std::array<double, 3>>();
      burst.place = Vec3d{xyz[0], xyz[1], xyz[2]};
      if (!std::isfinite(norm(*burst.place))) {
        return bad_input(place + ".place is not finite");
      }
    } else if (json.contains("weights")) {
      const auto cells = chain_count_from_json(json.at("cells"), place + ".cells");
      RAYLOC_TRY(cells);
      const auto weights = *cells > 0 && *cells < kMaxCells
                               ? decode<std::uint8_t>(json["weights"], *cells, place + ".weights")
                               : bad_input(place + ".cells is not a number of cells");
      RAYLOC_TRY(weights);
      for (const std::uint8_t one : *weights) {
        burst.log_weight.push_back(static_cast<float>(-kWeightStep * static_cast<double>(one)));
      }
    }
    return burst;
  }

  static constexpr std::size_t kMaxCells = 1'000'000;  // a count, chosen: far above any grid

  std::size_t chains_;
  std::size_t tones_;
};

}  // namespace

Expected<std::size_t> chain_count_from_json(const Json& json, const std::string& key) {
  if (!json.is_number_unsigned() || json.get<std::uint64_t>() > kMaxChainCount) {
    return bad_input(key + " is not a count");
  }
  return json.get<std::size_t>();
}

Expected<Timestamp> chain_time_from_json(const Json& json, const std::string& key) {
  const bool is_too_late =
      json.is_number_unsigned() && json.get<std::uint64_t>() > std::uint64_t{kMaxTime};
  if (!json.is_number_integer() || is_too_late || json.get<std::int64_t>() < -kMaxTime) {
    return bad_input(key + " is not a time");
  }
  return Timestamp(Duration(json.get<std::int64_t>()));
}

Json to_json(const ChainRecord& record) {
  Json favourite = Json::array();
  for (const Value& one : record.favourite) {
    favourite.push_back({one.real(), one.imag()});
  }
  Json received = Json::array();
  for (const ChainRecord::Burst& burst : record.received) {
    received.push_back(burst_json(burst));
  }
  return {{"learner", record.learner},
          {"learners", record.learners},
          {"bursts", record.bursts},
          {"bursts_needed", record.bursts_needed},
          {"lead", record.lead},
          {"phase_sigma_rad",
           record.phase_sigma < kMaxChainSigma ? record.phase_sigma : kMaxChainSigma},
          {"unrefined", record.unrefined},
          {"belief", encode(record.belief)},
          {"gain", record.gain},
          {"favourite", std::move(favourite)},
          {"received", std::move(received)}};
}

Expected<ChainRecord> record_from_json(const Json& json,
                                       const std::string& place,
                                       const RoomModel& room,
                                       std::size_t access_point) {
  try {
    return RecordReader(room, access_point).read(json, place);
  } catch (const nlohmann::json::exception& error) {
    return bad_input(place + ": " + error.what());
  }
}

}  // namespace rayloc
