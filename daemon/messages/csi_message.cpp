#include "daemon/messages/csi_message.h"

#include <algorithm>

#include "daemon/messages/proto_time.h"

namespace rayloc {
namespace {

v1::PhyFormat phy_proto(PhyFormat phy) {
  switch (phy) {
    case PhyFormat::kLegacy:
      return v1::PHY_FORMAT_LEGACY;
    case PhyFormat::kHt:
      return v1::PHY_FORMAT_HT;
    case PhyFormat::kVht:
      return v1::PHY_FORMAT_VHT;
    case PhyFormat::kHe:
      return v1::PHY_FORMAT_HE;
  }
  return v1::PHY_FORMAT_UNSPECIFIED;
}

void set_values(const CsiFrame& frame, v1::CsiFrame* message) {
  const Csi& csi = frame.csi;
  message->mutable_csi()->Reserve(
      static_cast<int>(2 * csi.antennas() * csi.streams() * csi.tones()));
  for (std::size_t rx_chain = 0; rx_chain < csi.antennas(); ++rx_chain) {
    for (std::size_t stream = 0; stream < csi.streams(); ++stream) {
      for (const std::complex<float> h : csi.row(rx_chain, stream)) {
        message->add_csi(h.real());
        message->add_csi(h.imag());
      }
    }
  }
}

}  // namespace

v1::CsiFrame csi_message(const CsiFrame& frame,
                         const std::string& access_point,
                         const std::string& transmitter) {
  v1::CsiFrame message;
  *message.mutable_time() = to_proto(frame.time);
  message.set_ap(access_point);
  message.set_transmitter(transmitter);
  message.set_format(std::string(frame.format));
  message.set_phy(phy_proto(frame.phy));
  message.set_bandwidth_mhz(static_cast<std::uint32_t>(frame.bandwidth_mhz));
  message.set_channel_bandwidth_mhz(static_cast<std::uint32_t>(frame.channel_bandwidth_mhz));
  if (frame.channel) {
    message.set_channel_centre_hz(frame.channel->centre_hz);
  }
  message.set_tone_spacing_hz(frame.tone_spacing_hz);
  message.set_sequence(frame.sequence);
  message.set_sequence_control(frame.sequence_control);
  for (const std::uint8_t rx_chain : frame.rx_chains) {
    message.add_cores(rx_chain);
  }
  message.set_streams(static_cast<std::uint32_t>(frame.csi.streams()));
  for (const std::int16_t tone : frame.tone_index) {
    message.add_tone_index(tone);
  }
  set_values(frame, &message);
  if (std::all_of(frame.power_dbm.begin(), frame.power_dbm.end(), [](const auto& power) {
        return power.has_value();
      })) {
    for (const std::optional<float>& power : frame.power_dbm) {
      message.add_power_dbm(*power);
    }
  }
  message.set_complete(frame.complete);
  for (const std::string_view flag : frame.flags) {
    message.add_flags(std::string(flag));
  }
  return message;
}

}  // namespace rayloc
