// CsiFrame: the CSI of one 802.11 frame as one access point received it; a plain value that capture
// fills and observe reads.
//
// The CSI is in the convention of the engine: time factor exp(+j w t), h(f) = sum a exp(-j 2 pi f
// tau), tones ascending, the 802.11 rotation undone, unusable tones (null, DC, guard) left out.
// Its scale is the extractor's own (after the receiver's gain control) and is not comparable
// between frames; `power_dbm` carries the power.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/channel/csi.h"
#include "engine/channel/mac_address.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

// Format of the 802.11 PPDU whose training field was measured.
enum class PhyFormat { kLegacy, kHt, kVht, kHe };
std::string_view to_string(PhyFormat phy);  // "legacy", "ht", "vht", "he"

struct CsiFrame {
  Timestamp time;                // arrival of the frame's first datagram; the frame's event time
  Timestamp time_last;           // arrival of its last datagram
  std::size_t access_point = 0;  // position in the site's list of access points
  MacAddress transmitter;
  std::string_view format;  // name of the wire format: "axcsi-v4"; static storage
  PhyFormat phy = PhyFormat::kLegacy;
  int bandwidth_mhz = 0;                // of the frame, from its energy
  int channel_bandwidth_mhz = 0;        // of the channel, from the size of the transform
  std::optional<RadioChannel> channel;  // of the radio, where the format states it
  double tone_spacing_hz = 312'500.0;
  std::uint16_t sequence = 0;            // the extractor's frame counter, where the format has one
  std::uint16_t sequence_control = 0;    // of the 802.11 header: number << 4 | fragment
  int transmitted_streams = 1;           // spatial streams of the transmission, if known
  std::vector<std::uint8_t> rx_chains;   // receive chains present, ascending; the rows of `csi`
  std::vector<std::int16_t> tone_index;  // ascending, counted from the centre of the channel
  Csi csi;                               // [rx_chain][stream][tone]
  std::vector<std::optional<float>> power_dbm;  // per entry of `rx_chains`
  bool complete = false;                        // no core, stream or tone block is missing
  // Names for people and scripts, static storage: "retry", "subband", "missing_core", ...
  std::vector<std::string_view> flags;
};

// True if the frame states the channel about the centre of `grid`, or no channel. A receiver
// accepts others only for a device that hops (CsiReceiverOptions::accepts_hops).
bool is_on(const OfdmGrid& grid, const CsiFrame& frame);
std::vector<CsiFrame> frames_on(const OfdmGrid& grid, std::span<const CsiFrame> frames);

}  // namespace rayloc
