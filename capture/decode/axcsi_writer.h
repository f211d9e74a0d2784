// Writes AX-CSI datagrams as the extractor sends them: the inverse of axcsi_decoder, for simulated
// captures.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "capture/decode/axcsi_decoder.h"

namespace rayloc {

// Maximum number of tones in one datagram.
inline constexpr std::size_t kAxcsiDatagramTones = 256;

// The CSI word (csi_words.h, kFloat12) nearest to `value`: the common exponent is the smallest that
// represents both parts, so the larger of them keeps 11 bits. Below 2^-33 it is 0. REQUIRES:
// finite, each part below 2^42.
std::uint32_t pack_axcsi_word(std::complex<double> value);

// Writes one datagram; `tones` in the order of the wire. REQUIRES: tones.size() == header.last_tone
// - header.first_tone + 1.
std::vector<std::byte> write_axcsi_datagram(const AxcsiHeader& header,
                                            std::span<const std::complex<double>> tones);

// The CSI of one 802.11 frame as several cores received it on one stream.
struct AxcsiFrame {
  // Fields that all datagrams share; core, first_tone, last_tone, total_tones and receive_sequence
  // are set by the writer.
  AxcsiHeader header;
  std::vector<std::uint8_t> rx_chains;
  // [rx_chain][tone], all tones of the channel in ascending order, with the 802.11 rotation.
  std::vector<std::complex<double>> tones;
};

// The frame's datagrams: for each core, for each 256 tones. REQUIRES: a number of tones that the
// format supports (64, 128, ... 2048).
std::vector<std::vector<std::byte>> write_axcsi_frame(const AxcsiFrame& frame);

}  // namespace rayloc
