// AX-CSI V0.0.4 ("axcsi-v4"): the extractor for Broadcom bcm43684 access points (RT-AX86U).
//
// The tones are on the wire in FFT order; our sign needs no conjugation. Proof on recordings: with
// the values unchanged, the 40 MHz step across DC is +90 degrees as the standard rotates it, and
// the apparent delay is positive (tests/capture/axcsi_decoder_test.cpp).
#pragma once

#include "capture/decode/csi_decoder.h"

namespace rayloc {

inline constexpr std::size_t kAxcsiHeaderBytes = 54;
inline constexpr unsigned kAxcsiEncodingHe = 3;  // value of AxcsiHeader::encoding()

// Every field of the header, with its unmodified value.
struct AxcsiHeader {
  MacAddress transmitter;
  std::uint16_t sequence = 0;  // the extractor's counter, +1 a frame
  std::uint16_t rx_chain = 0;
  std::uint16_t stream = 0;
  std::uint16_t first_tone = 0;
  std::uint16_t last_tone = 0;  // inclusive
  std::uint16_t total_tones = 0;
  std::uint16_t sequence_control = 0;
  std::uint32_t ratespec = 0;
  std::uint64_t receive_ticks = 0;  // 48 bits, counts down, 242.25 MHz; 0 in all known recordings
  std::uint16_t receive_sequence = 0;  // a copy of sequence_control
  std::uint32_t receive_time_us = 0;
  std::uint64_t transmit_ticks = 0;
  std::uint16_t transmit_sequence = 0;
  std::array<std::int8_t, kMaxRxChains> power_dbm{};  // by core
  std::uint32_t phy_status = 0;
  std::uint16_t chanspec = 0;

  // Fields of `ratespec`. Its bandwidth is not reliable (WIRE_FORMATS 1.2) and is not used here.
  unsigned encoding() const { return (ratespec >> 24U) & 7U; }  // 0 legacy, 1 HT, 2 VHT, 3 HE
  unsigned rate_bandwidth() const { return (ratespec >> 16U) & 7U; }
  unsigned streams() const;  // spatial streams, not counting space-time coding
  unsigned mcs() const;      // legacy: rate in 500 kb/s
  bool space_time_coded() const { return ((ratespec >> 20U) & 1U) != 0; }
};

tl::expected<AxcsiHeader, RejectReason> read_axcsi_header(std::span<const std::byte> payload);

class AxcsiDecoder final : public CsiDecoder {
 public:
  std::string_view format() const override { return "axcsi-v4"; }
  DecodeResult decode(std::span<const std::byte> payload) const override;
};

// True if the length matches the header, or if all fields that have few legal values have one:
// distinguishes a damaged AX-CSI datagram from other data.
bool resembles_axcsi(std::span<const std::byte> payload);

}  // namespace rayloc
