#include "daemon/simulate/simulate_report.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

namespace rayloc::cli {
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
  for (std::size_t core = 0; core < chains.cores.size(); ++core) {
    std::complex<double> ratio;
    double power = 0.0;
    for (std::size_t k = 0; k < tones; ++k) {
      ratio += chains.gain[core * tones + k] * std::conj(chains.gain[k]);
      power += std::norm(chains.gain[k]);
    }
    ratio /= power;
    json.push_back({{"core", chains.cores[core]},
                    {"gain_db", 20.0 * std::log10(std::abs(ratio))},
                    {"phase_deg", std::arg(ratio) * 180.0 / std::numbers::pi}});
  }
  return json;
}

}  // namespace

std::string simulation_json(const CaptureOptions& options,
                            std::span<const SimulatedSpot> spots,
                            std::span<const CaptureReport> captures) {
  std::size_t frames = 0;
  Json points = Json::array();
  for (const SimulatedSpot& spot : spots) {
    frames += spot.frames.size();
    points.push_back({{"line", spot.line},
                      {"x", spot.position.x},
                      {"y", spot.position.y},
                      {"z", spot.position.z}});
  }
  Json access_points = Json::array();
  for (const CaptureReport& capture : captures) {
    access_points.push_back({{"id", capture.access_point},
                             {"file", capture.file},
                             {"datagrams", capture.datagrams},
                             {"lost", capture.lost},
                             {"unheard_lines", capture.unheard_lines},
                             {"chains", chains_json(capture.chains)}});
  }
  const Json json = {{"seed", options.seed},
                     {"transmitter", to_string(options.transmitter)},
                     {"depth", options.trace.max_depth},
                     {"transmission", options.trace.transmission},
                     {"model_error", options.model_error},
                     {"frames", frames},
                     {"impairments", impairments_json(options.impairments)},
                     {"access_points", std::move(access_points)},
                     {"points", std::move(points)}};
  return json.dump() + "\n";
}

}  // namespace rayloc::cli
