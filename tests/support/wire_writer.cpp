#include "tests/support/wire_writer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rayloc::test {
namespace {

using Bytes = std::vector<std::byte>;

void put(Bytes& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 0xff));
  }
}

void put_address(Bytes& bytes, std::uint64_t address) {
  for (int shift = 40; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(address >> shift & 0xff));
  }
}

int tones_per_20_mhz(WirePhy phy) { return phy == WirePhy::kHe ? 256 : 64; }

// 802.11-2020 21.3.7.5: 40 MHz rotates the upper half by 90 degrees, 80 MHz all but the lowest
// quarter by 180 degrees, 160 MHz each of its halves as 80 MHz.
std::complex<double> rotation(const WireFrame& frame, int tone) {
  if (frame.phy == WirePhy::kHe || frame.occupied_mhz == 20) {
    return 1.0;
  }
  if (frame.occupied_mhz == 40) {
    return tone < 0 ? std::complex<double>(1.0) : std::complex<double>(0.0, 1.0);
  }
  const int within_80 = frame.occupied_mhz == 160 ? (tone < 0 ? tone + 128 : tone - 128) : tone;
  return within_80 < -64 ? 1.0 : -1.0;
}

bool within(int value, int first, int last) { return value >= first && value <= last; }

// Nulls by index of the transform, as the published AX-CSI converter zeroes them.
bool is_null_of_he(int index, int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return within(index, 0, 1) || within(index, 123, 133) || index == 255;
    case 40:
      return within(index, 0, 2) || within(index, 245, 267) || index >= 510;
    case 80:
      return within(index, 0, 2) || within(index, 501, 523) || index >= 1022;
    default:
      return within(index, 0, 11) || within(index, 510, 514) || within(index, 1012, 1035) ||
             within(index, 1533, 1538) || index >= 2037;
  }
}

// Nulls by position from the lowest tone, as SHARP lists them.
bool is_null_of_vht(int position, int bandwidth_mhz) {
  switch (bandwidth_mhz) {
    case 20:
      return position <= 3 || position == 32 || position >= 61;
    case 40:
      return position <= 5 || within(position, 63, 65) || position >= 123;
    case 80:
      return position <= 5 || within(position, 127, 129) || position >= 251;
    default:
      return is_null_of_vht(position % 256, 80);
  }
}

bool sounded(const WireFrame& frame, int tone) {
  const int count = frame.occupied_mhz / 20 * tones_per_20_mhz(frame.phy);
  if (tone < -count / 2 || tone >= count / 2 || tone % frame.training_stride != 0) {
    return false;
  }
  switch (frame.phy) {
    case WirePhy::kHe:
      return !is_null_of_he((tone + count) % count, frame.occupied_mhz);
    case WirePhy::kLegacy: {
      const int in_part = (tone + count / 2) % 64 - 32;
      return in_part != 0 && std::abs(in_part) <= 26;
    }
    default:
      return !is_null_of_vht(tone + count / 2, frame.occupied_mhz);
  }
}

// Position of a tone on the wire: FFT order; 160 MHz of 512 tones is two blocks, upper half first.
std::size_t position(const WireFrame& frame, int tone, int total) {
  if (total == 512 && frame.phy != WirePhy::kHe) {
    const int in_half = tone < 0 ? tone + 128 : tone - 128;
    return static_cast<std::size_t>((in_half + 256) % 256) + (tone < 0 ? 256U : 0U);
  }
  return static_cast<std::size_t>((tone + total) % total);
}

// Sign and `bits` of magnitude, starting at bit `shift`.
std::uint32_t sign_magnitude(double value, int exponent, int bits, int shift) {
  const auto magnitude =
      static_cast<std::uint32_t>(std::lround(std::ldexp(std::abs(value), -exponent)));
  return (magnitude | (value < 0 ? 1U << bits : 0U)) << shift;
}

std::uint32_t pack(std::complex<double> value, int mantissa_bits, int exponent_bits) {
  const double largest = std::max(std::abs(value.real()), std::abs(value.imag()));
  const int lowest = -(1 << (exponent_bits - 1));
  int exponent = largest > 0 ? std::ilogb(largest) + 1 - mantissa_bits : lowest;
  if (std::lround(std::ldexp(largest, -exponent)) >= 1 << mantissa_bits) {
    ++exponent;
  }
  exponent = std::max(exponent, lowest);
  if (exponent > -lowest - 1) {
    throw std::range_error("value too large for the wire");
  }
  return (static_cast<std::uint32_t>(exponent) & ((1U << exponent_bits) - 1U)) |
         sign_magnitude(value.imag(), exponent, mantissa_bits, exponent_bits) |
         sign_magnitude(value.real(), exponent, mantissa_bits, exponent_bits + mantissa_bits + 1);
}

std::uint32_t ratespec_of(const WireFrame& frame) {
  const auto encoding = static_cast<std::uint32_t>(frame.phy);
  const std::uint32_t bandwidth = 1;  // always "20 MHz": no decoder may rely on it
  std::uint32_t rate = 0x0c;
  if (frame.phy == WirePhy::kHt) {
    rate = static_cast<std::uint32_t>(8 * (frame.transmitted_streams - 1) + 4);
  } else if (frame.phy != WirePhy::kLegacy) {
    rate = static_cast<std::uint32_t>(frame.transmitted_streams) << 4U | 7U;
  }
  return encoding << 24U | bandwidth << 16U | rate;
}

std::uint16_t chanspec_of(const WireFrame& frame) {
  if (frame.chanspec != 0) {
    return frame.chanspec;
  }
  switch (frame.channel_mhz) {
    case 20:
      return 0xd024;
    case 40:
      return 0xd826;
    case 80:
      return 0xe02a;
    default:
      return 0xe832;
  }
}

}  // namespace

WireChannel delayed_path(double delay, double spacing_hz) {
  return [delay, spacing_hz](int rx_chain, int stream, int tone) {
    const double phase = -2.0 * std::numbers::pi * spacing_hz * tone * delay;
    return std::polar(100.0, phase + 0.7 * rx_chain - 1.1 * stream);
  };
}

std::uint32_t pack_float12(std::complex<double> value) { return pack(value, 11, 6); }
std::uint32_t pack_float9(std::complex<double> value) { return pack(value, 8, 5); }
std::uint32_t pack_int16(std::complex<double> value) {
  const auto half = [](double part) {
    return static_cast<std::uint32_t>(static_cast<std::uint16_t>(std::lround(part)));
  };
  return half(value.real()) | half(value.imag()) << 16U;
}

std::vector<std::complex<double>> wire_tones(const WireFrame& frame, int rx_chain, int stream) {
  const int total = frame.channel_mhz / 20 * tones_per_20_mhz(frame.phy);
  std::vector<std::complex<double>> tones(static_cast<std::size_t>(total));
  for (int tone = -total / 2; tone < total / 2; ++tone) {
    // Noise 46 dB down, a function of the tone so that runs agree.
    std::complex<double> value = std::polar(0.5, 2.399963 * tone * tone + rx_chain);
    const int own = tone - frame.centre_tone;
    if (sounded(frame, own)) {
      value = rotation(frame, own) * frame.channel(rx_chain, stream, tone);
    } else if (tone == 0) {
      value = 50.0 * frame.garbage_at_centre;
    }
    tones[position(frame, tone, total)] = value;
  }
  return tones;
}

Recording write_axcsi(const WireFrame& frame, Timestamp time) {
  Recording recording;
  for (const int rx_chain : frame.rx_chains) {
    for (int stream = 0; stream < frame.streams; ++stream) {
      const auto tones = wire_tones(frame, rx_chain, stream);
      for (std::size_t first = 0; first < tones.size(); first += 256) {
        const std::size_t count = std::min<std::size_t>(256, tones.size() - first);
        Bytes bytes;
        put_address(bytes, frame.transmitter);
        put(bytes, frame.sequence, 2);
        put(bytes, static_cast<std::uint64_t>(rx_chain), 2);
        put(bytes, static_cast<std::uint64_t>(stream), 2);
        put(bytes, first, 2);
        put(bytes, first + count - 1, 2);
        put(bytes, tones.size(), 2);
        put(bytes, frame.sequence_control, 2);
        put(bytes, ratespec_of(frame), 4);
        put(bytes, 0, 6);
        put(bytes, frame.sequence_control, 2);
        put(bytes, 0, 4);
        put(bytes, 0, 8);
        for (std::size_t i = 4; i-- > 0;) {
          put(bytes, static_cast<std::uint64_t>(frame.power_dbm.at(i)), 1);
        }
        put(bytes, 0x0843, 4);
        put(bytes, chanspec_of(frame), 2);
        for (std::size_t i = first; i < first + count; ++i) {
          put(bytes, pack_float12(tones[i]), 4);
        }
        recording.push_back({time, std::move(bytes)});
      }
    }
  }
  return recording;
}

Recording write_nexmon(const WireFrame& frame, NexmonChip chip, int version, Timestamp time) {
  Recording recording;
  for (const int rx_chain : frame.rx_chains) {
    for (int stream = 0; stream < frame.streams; ++stream) {
      auto tones = wire_tones(frame, rx_chain, stream);
      Bytes bytes;
      put(bytes, 0x1111, 2);
      put(bytes, version == 1 ? 0x11 : static_cast<std::uint64_t>(frame.power_dbm.at(0)), 1);
      put(bytes, version == 1 ? 0x11 : 0x88, 1);
      put_address(bytes, frame.transmitter);
      put(bytes, frame.sequence_control, 2);
      const auto configuration = static_cast<std::uint64_t>(rx_chain | stream << 3);
      put(bytes, chip == NexmonChip::k4366c0 ? configuration << 8U : configuration, 2);
      put(bytes, chanspec_of(frame), 2);
      put(bytes, static_cast<std::uint64_t>(chip), 2);
      for (std::size_t i = 0; i < tones.size(); ++i) {
        const std::size_t overwritten = tones.size() == 64 ? 28 : 0;
        std::uint32_t word = 0;
        if (version == 2 && i >= overwritten && i < overwritten + 3) {
          word = 0x2fffc01fU;  // any PhyRxStatus: read as CSI, a large value
        } else if (chip == NexmonChip::k4366c0) {
          word = pack_float12(tones[i]);
        } else if (chip == NexmonChip::k4358) {
          word = pack_float9(tones[i]);
        } else {
          word = pack_int16(tones[i]);
        }
        put(bytes, word, 4);
      }
      recording.push_back({time, std::move(bytes)});
    }
  }
  return recording;
}

Recording write_ubilocate(const WireFrame& frame, Timestamp time) {
  std::uint64_t core_mask = 0;
  for (const int rx_chain : frame.rx_chains) {
    core_mask |= std::uint64_t{1} << rx_chain;
  }
  Recording recording;
  for (const int rx_chain : frame.rx_chains) {
    for (int stream = 0; stream < frame.streams; ++stream) {
      Bytes bytes;
      put(bytes, 0x1111, 2);
      put(bytes, core_mask, 1);
      put(bytes, (std::uint64_t{1} << frame.streams) - 1, 1);
      put_address(bytes, frame.transmitter);
      put(bytes, frame.sequence_control, 2);
      put(bytes, 4 * static_cast<std::uint64_t>(rx_chain) + static_cast<std::uint64_t>(stream), 2);
      put(bytes, chanspec_of(frame), 2);
      put(bytes, frame.sequence, 2);
      for (const std::complex<double> tone : wire_tones(frame, rx_chain, stream)) {
        put(bytes, pack_float12(tone), 4);
      }
      const bool first = recording.empty();
      put(bytes, first ? 0x0827deaf : 0x12345678, 4);
      put(bytes, 0, 3);
      for (std::size_t i = 0; i < 4; ++i) {
        put(bytes, first ? static_cast<std::uint64_t>(frame.power_dbm.at(i)) : 0x55, 1);
      }
      put(bytes, 0, 8);
      while (bytes.size() % 128 != 18) {
        put(bytes, 0, 1);
      }
      recording.push_back({time, std::move(bytes)});
    }
  }
  return recording;
}

}  // namespace rayloc::test
