// axcsi_decoder.cpp documents the layout.
#include "capture/decode/axcsi_writer.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr int kMantissaBits = 11;
constexpr int kExponentBits = 6;
constexpr int kLowestExponent = -32;
constexpr int kHighestExponent = 31;

void put(std::vector<std::byte>& bytes, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xffU));
  }
}

// Sign bit above the magnitude.
std::uint32_t sign_magnitude(double value, int exponent) {
  const auto magnitude =
      static_cast<std::uint32_t>(std::llround(std::ldexp(std::abs(value), -exponent)));
  return magnitude | (value < 0.0 ? 1U << kMantissaBits : 0U);
}

void put_header(std::vector<std::byte>& bytes, const AxcsiHeader& header) {
  for (const std::uint8_t octet : header.transmitter.octets) {
    put(bytes, octet, 1);
  }
  put(bytes, header.sequence, 2);
  put(bytes, header.rx_chain, 2);
  put(bytes, header.stream, 2);
  put(bytes, header.first_tone, 2);
  put(bytes, header.last_tone, 2);
  put(bytes, header.total_tones, 2);
  put(bytes, header.sequence_control, 2);
  put(bytes, header.ratespec, 4);
  put(bytes, header.receive_ticks, 6);
  put(bytes, header.receive_sequence, 2);
  put(bytes, header.receive_time_us, 4);
  put(bytes, header.transmit_ticks, 6);
  put(bytes, header.transmit_sequence, 2);
  for (std::size_t rx_chain = kMaxRxChains; rx_chain-- > 0;) {
    put(bytes, static_cast<std::uint8_t>(header.power_dbm[rx_chain]), 1);
  }
  put(bytes, header.phy_status, 4);
  put(bytes, header.chanspec, 2);
}

// Converts ascending tones to the order of the wire (WIRE_FORMATS 1.4): FFT order; 160 MHz in 512
// tones is two transforms, the upper half first.
std::vector<std::complex<double>> wire_order(std::span<const std::complex<double>> tones,
                                             bool two_transforms) {
  const std::size_t n = tones.size();
  std::vector<std::complex<double>> wire(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t position =
        two_transforms ? (i + 128) % 256 + (i < 256 ? 256 : 0) : (i + n / 2) % n;
    wire[position] = tones[i];
  }
  return wire;
}

}  // namespace

std::uint32_t pack_axcsi_word(std::complex<double> value) {
  const double largest = std::max(std::abs(value.real()), std::abs(value.imag()));
  RAYLOC_CHECK(std::isfinite(largest));
  int exponent = largest > 0.0 ? std::max(std::ilogb(largest) + 1 - kMantissaBits, kLowestExponent)
                               : kLowestExponent;
  if (std::llround(std::ldexp(largest, -exponent)) >= 1 << kMantissaBits) {
    ++exponent;  // 2047.6 rounds to a magnitude that does not fit
  }
  RAYLOC_CHECK(exponent <= kHighestExponent);
  return sign_magnitude(value.real(), exponent) << (kExponentBits + kMantissaBits + 1) |
         sign_magnitude(value.imag(), exponent) << kExponentBits |
         (static_cast<std::uint32_t>(exponent) & ((1U << kExponentBits) - 1U));
}

std::vector<std::byte> write_axcsi_datagram(const AxcsiHeader& header,
                                            std::span<const std::complex<double>> tones) {
  RAYLOC_CHECK(header.first_tone <= header.last_tone &&
               tones.size() == header.last_tone - header.first_tone + std::size_t{1});
  std::vector<std::byte> bytes;
  bytes.reserve(kAxcsiHeaderBytes + kBytesPerWord * tones.size());
  put_header(bytes, header);
  for (const std::complex<double>& tone : tones) {
    put(bytes, pack_axcsi_word(tone), kBytesPerWord);
  }
  return bytes;
}

std::vector<std::vector<std::byte>> write_axcsi_frame(const AxcsiFrame& frame) {
  RAYLOC_CHECK(!frame.rx_chains.empty() && frame.tones.size() % frame.rx_chains.size() == 0);
  const std::size_t total = frame.tones.size() / frame.rx_chains.size();
  RAYLOC_CHECK(total >= kToneBlock && total <= kMaxTones && (total & (total - 1)) == 0);
  const bool two_transforms = total == 512 && frame.header.encoding() != kAxcsiEncodingHe;
  AxcsiHeader header = frame.header;
  header.total_tones = static_cast<std::uint16_t>(total);
  header.receive_sequence = header.sequence_control;
  std::vector<std::vector<std::byte>> datagrams;
  for (std::size_t rx_chain = 0; rx_chain < frame.rx_chains.size(); ++rx_chain) {
    header.rx_chain = frame.rx_chains[rx_chain];
    const auto wire =
        wire_order(std::span(frame.tones).subspan(rx_chain * total, total), two_transforms);
    for (std::size_t first = 0; first < total; first += kAxcsiDatagramTones) {
      const std::size_t count = std::min(kAxcsiDatagramTones, total - first);
      header.first_tone = static_cast<std::uint16_t>(first);
      header.last_tone = static_cast<std::uint16_t>(first + count - 1);
      datagrams.push_back(write_axcsi_datagram(header, std::span(wire).subspan(first, count)));
    }
  }
  return datagrams;
}

}  // namespace rayloc
