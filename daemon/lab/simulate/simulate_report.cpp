#include "daemon/lab/simulate/simulate_report.h"

#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <variant>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "engine/base/constants.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json impairments_json(const Impairments& impairments) {
  Json json = Json::object();
  for (const ImpairmentKey& key : impairment_keys()) {
    if (const auto* flag = std::get_if<bool Impairments::*>(&key.member)) {
      json[std::string(key.key)] = impairments.**flag;
    } else {
      json[std::string(key.key)] = impairments.*std::get<double Impairments::*>(key.member);
    }
  }
  return json;
}

Json chains_json(const ChainGains& chains) {
  const std::size_t tones = chains.grid.size();
  Json json = Json::array();
  for (std::size_t rx_chain = 0; rx_chain < chains.rx_chains.size(); ++rx_chain) {
    std::complex<double> ratio;
    double power = 0.0;
    for (std::size_t k = 0; k < tones; ++k) {
      ratio += chains.gain[rx_chain * tones + k] * std::conj(chains.gain[k]);
      power += std::norm(chains.gain[k]);
    }
    ratio /= power;
    json.push_back({{"core", chains.rx_chains[rx_chain]},
                    {"gain_db", 20.0 * std::log10(std::abs(ratio))},
                    {"phase_deg", std::arg(ratio) * 180.0 / std::numbers::pi}});
  }
  return json;
}

// Tilt of a test point's device from upright, and the side to which it leans.
struct Tilt {
  double angle_deg = 0.0;
  double towards_deg = 0.0;
};

Tilt tilt_of(const SimulatedPoint& test_point) {
  const Vec3d up = rotation(test_point.orientation) * Vec3d{0.0, 0.0, 1.0};
  const double across = std::hypot(up.x, up.y);
  return {std::atan2(across, up.z) / kDegree, std::atan2(up.y, up.x) / kDegree};
}

Json point_json(const SimulatedPoint& test_point, bool is_handled) {
  Json json = {{"line", test_point.line},
               {"x", test_point.position.x},
               {"y", test_point.position.y},
               {"z", test_point.position.z}};
  if (is_handled) {
    const Tilt tilt = tilt_of(test_point);
    json["tilt_deg"] = tilt.angle_deg;
    json["tilt_towards_deg"] = tilt.towards_deg;
    json["power_db"] = test_point.power_db;
  }
  return json;
}

Json handling_json(const Handling& handling) {
  return {{"height_sigma_m", handling.height_sigma},
          {"tilt_deg", handling.tilt_deg},
          {"power_sigma_db", handling.power_sigma_db}};
}

Json vector_json(const Vec3d& v) { return Json::array({v.x, v.y, v.z}); }

Json second_day_json(const SecondDay& day, const LivedInRoom& lived) {
  Json json = Json::object();
  for (const SecondDayKey& key : second_day_keys()) {
    json[std::string(key.key)] = day.*key.member;
  }
  Json& things = json["things"] = Json::array();
  for (const MovedThing& thing : lived.moved) {
    things.push_back({{"objects", thing.objects}, {"by", vector_json(thing.by)}});
  }
  Json& access_points = json["access_points"] = Json::array();
  for (std::size_t i = 0; i < lived.access_points.size(); ++i) {
    const BumpedAccessPoint& ap = lived.access_points[i];
    access_points.push_back({{"id", lived.room.access_points[i].id},
                             {"moved_m", vector_json(ap.moved)},
                             {"yaw_deg", ap.rotated.yaw / kDegree},
                             {"pitch_deg", ap.rotated.pitch / kDegree},
                             {"roll_deg", ap.rotated.roll / kDegree}});
  }
  return json;
}

std::string seconds_text(Timestamp time) {
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  return fmt::format("{}.{:09d}", seconds.count(), (since - seconds).count());
}

}  // namespace

std::string simulation_json(const SimulatedTruth& truth) {
  std::size_t frames = 0;
  Json points = Json::array();
  for (const SimulatedPoint& test_point : truth.test_points) {
    frames += test_point.frames.size();
    points.push_back(point_json(test_point, truth.handling.changes_anything()));
  }
  Json access_points = Json::array();
  for (const CaptureReport& capture : truth.captures) {
    access_points.push_back({{"id", capture.access_point},
                             {"file", capture.file},
                             {"datagrams", capture.datagrams},
                             {"lost", capture.lost},
                             {"unheard_lines", capture.lines_without_path},
                             {"chains", chains_json(capture.chains)}});
  }
  const CaptureOptions& options = truth.options;
  Json json = {{"seed", options.seed},
               {"transmitter", to_string(options.transmitter)},
               {"depth", options.trace.max_depth},
               {"transmission", options.trace.transmission},
               {"model_error", options.model_error},
               {"frames", frames},
               {"impairments", impairments_json(options.impairments)},
               {"access_points", std::move(access_points)},
               {"points", std::move(points)}};
  if (options.trace.diffuse) {
    json["diffuse"] = true;
  }
  for (const RadioChannel& channel : truth.channels) {
    json["channels"].push_back(
        {{"centre_hz", channel.centre_hz}, {"bandwidth_mhz", channel.bandwidth_mhz}});
  }
  if (truth.handling.changes_anything()) {
    json["handling"] = handling_json(truth.handling);
  }
  if (truth.day) {
    json["second_day"] = second_day_json(*truth.day, truth.lived);
  }
  return json.dump() + "\n";
}

std::string truth_csv(const SimulatedTruth& truth) {
  const bool is_handled = truth.handling.changes_anything();
  std::string csv = truth.is_walk ? "t,x,y,z" : "t_start,t_end,x,y,z";
  csv += is_handled ? ",tilt_deg,tilt_towards_deg,power_db\n" : "\n";
  for (const SimulatedPoint& test_point : truth.test_points) {
    csv += seconds_text(test_point.t_start);
    csv += truth.is_walk ? "" : "," + seconds_text(test_point.t_end);
    const Vec3d& place = test_point.position;
    csv += fmt::format(",{:.6f},{:.6f},{:.6f}", place.x, place.y, place.z);
    if (is_handled) {
      const Tilt tilt = tilt_of(test_point);
      csv += fmt::format(
          ",{:.3f},{:.3f},{:.3f}", tilt.angle_deg, tilt.towards_deg, test_point.power_db);
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace rayloc
