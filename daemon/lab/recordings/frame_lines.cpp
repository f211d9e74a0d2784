#include "daemon/lab/recordings/frame_lines.h"

#include <complex>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/lab/recordings/time_text.h"

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

Json values_of(const CsiFrame& frame) {
  Json rx_chains = Json::array();
  for (std::size_t rx_chain = 0; rx_chain < frame.csi.antennas(); ++rx_chain) {
    Json streams = Json::array();
    for (std::size_t stream = 0; stream < frame.csi.streams(); ++stream) {
      Json tones = Json::array();
      for (const std::complex<float> h : frame.csi.row(rx_chain, stream)) {
        tones.push_back(Json::array({h.real(), h.imag()}));
      }
      streams.push_back(std::move(tones));
    }
    rx_chains.push_back(std::move(streams));
  }
  return rx_chains;
}

}  // namespace

std::string frame_json(const CsiFrame& frame, const std::string& access_point, bool values) {
  Json power = Json::array();
  for (const std::optional<float>& dbm : frame.power_dbm) {
    power.push_back(dbm ? Json(*dbm) : Json(nullptr));
  }
  Json line = {{"time", time_text(frame.time)},
               {"ap", access_point},
               {"transmitter", to_string(frame.transmitter)},
               {"format", frame.format},
               {"phy", to_string(frame.phy)},
               {"bandwidth_mhz", frame.bandwidth_mhz},
               {"sequence", frame.sequence},
               {"sequence_control", frame.sequence_control},
               {"cores", frame.rx_chains},
               {"streams", frame.csi.streams()},
               {"tones", frame.csi.tones()},
               {"power_dbm", std::move(power)},
               {"complete", frame.complete},
               {"flags", frame.flags}};
  if (frame.channel) {
    line["centre_hz"] = frame.channel->centre_hz;
  }
  if (values) {
    line["tone_index"] = frame.tone_index;
    line["csi"] = values_of(frame);
  }
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string frame_text(const CsiFrame& frame, const std::string& access_point) {
  std::string rx_chains;
  std::string power;
  for (std::size_t i = 0; i < frame.rx_chains.size(); ++i) {
    rx_chains += (i == 0 ? "" : ",") + std::to_string(frame.rx_chains[i]);
    power += i == 0 ? "" : ",";
    power += frame.power_dbm[i] ? std::to_string(static_cast<int>(*frame.power_dbm[i])) : "?";
  }
  std::string line = time_text(frame.time) + "  " + access_point + "  " +
                     to_string(frame.transmitter) + "  " + std::string(frame.format) + "  " +
                     std::string(to_string(frame.phy)) + " " + std::to_string(frame.bandwidth_mhz) +
                     " MHz  sequence " + std::to_string(frame.sequence) + "/" +
                     std::to_string(frame.sequence_control) + "  cores " + rx_chains +
                     "  streams " + std::to_string(frame.csi.streams()) + "  tones " +
                     std::to_string(frame.csi.tones()) + "  " + power + " dBm";
  line += frame.complete ? "" : "  incomplete";
  for (const std::string_view flag : frame.flags) {
    line += "  " + std::string(flag);
  }
  return line;
}

}  // namespace rayloc
