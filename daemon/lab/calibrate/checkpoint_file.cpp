#include "daemon/lab/calibrate/checkpoint_file.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/site/model/site_copy.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

using Json = nlohmann::json;

tl::unexpected<Error> unusable(const std::filesystem::path& file, const std::string& why) {
  return bad_input(file.string() + ": " + why + "; calibrate again without --resume");
}

}  // namespace

std::string to_json_text(const StoredCheckpoint& stored, const std::string& inputs) {
  const JointCheckpoint& checkpoint = stored.reached;
  Json survey = Json::array();
  for (const Vec3d& error : checkpoint.state.survey) {
    survey.push_back({error.x, error.y, error.z});
  }
  Json gains = Json::array();
  for (const ChainGains& one : checkpoint.gains) {
    Json values = Json::array();
    for (const auto& gain : one.gain) {
      values.push_back({gain.real(), gain.imag()});
    }
    gains.push_back(std::move(values));
  }
  Json cycles = Json::array();
  for (const WaveCycle& one : checkpoint.other_cycles) {
    cycles.push_back({one.surface, one.offset, one.excess});
  }
  Json history = Json::array();
  for (const CalibrationStep& step : checkpoint.history) {
    history.push_back({step.stage, step.iteration, step.loss, step.heldout});
  }
  return Json{{"inputs", inputs},
              {"seconds", stored.seconds},
              {"rounds", checkpoint.rounds},
              {"last_kept", checkpoint.last_kept},
              {"values", checkpoint.state.values},
              {"survey", std::move(survey)},
              {"gains", std::move(gains)},
              {"other_cycles", std::move(cycles)},
              {"history", std::move(history)},
              {"survey_sigma", checkpoint.survey_sigma}}
             .dump() +
         "\n";
}

Expected<StoredCheckpoint> load_checkpoint(const std::filesystem::path& file,
                                           const std::string& inputs,
                                           const RoomModel& room,
                                           std::size_t points) {
  const auto text = read_file(file);
  if (!text) {
    return bad_input(file.string() +
                     ": there is no interrupted calibration to resume; leave out "
                     "--resume");
  }
  const Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) {
    return unusable(file, "is no JSON");
  }
  StoredCheckpoint stored;
  JointCheckpoint& checkpoint = stored.reached;
  try {
    if (json.at("inputs") != inputs) {
      return unusable(file, "was made from other inputs or options");
    }
    stored.seconds = json.at("seconds");
    checkpoint.rounds = json.at("rounds");
    checkpoint.last_kept = json.at("last_kept");
    checkpoint.state.values = json.at("values").get<std::vector<double>>();
    for (const Json& error : json.at("survey")) {
      checkpoint.state.survey.push_back({error.at(0), error.at(1), error.at(2)});
    }
    checkpoint.survey_sigma = json.at("survey_sigma");
    for (std::size_t a = 0; a < room.access_points.size(); ++a) {
      const RoomAccessPoint& ap = room.access_points[a];
      ChainGains gains{ap.gains.grid, ap.rx_chains, {}, ap.gains.coupling};
      for (const Json& gain : json.at("gains").at(a)) {
        gains.gain.emplace_back(gain.at(0).get<double>(), gain.at(1).get<double>());
      }
      if (gains.gain.size() != ap.gains.gain.size()) {
        return unusable(file, "has other gains than the site");
      }
      checkpoint.gains.push_back(std::move(gains));
    }
    for (const Json& one : json.at("other_cycles")) {
      checkpoint.other_cycles.push_back({one.at(0), one.at(1), one.at(2)});
      if (checkpoint.other_cycles.back().surface >= room.scene->surfaces().size()) {
        return unusable(file, "has other surfaces than the site");
      }
    }
    for (const Json& step : json.at("history")) {
      checkpoint.history.push_back({step.at(0), step.at(1), step.at(2), step.at(3)});
    }
  } catch (const Json::exception& error) {
    return unusable(file, error.what());
  }
  if (checkpoint.state.values.size() != RoomUnknowns(room, {}).size() ||
      checkpoint.state.survey.size() != points || checkpoint.last_kept < 0 ||
      checkpoint.rounds < 0 || checkpoint.last_kept > std::max(0, checkpoint.rounds - 1) ||
      checkpoint.rounds > kJointRounds) {
    return unusable(file, "has other numbers than the site");
  }
  return stored;
}

}  // namespace rayloc
