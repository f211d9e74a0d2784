// The header fields shared by nexmon and UbiLocate: both begin like the header of nexmon_csi.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "capture/decode/chanspec.h"
#include "capture/transport/byte_reader.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

inline constexpr std::uint16_t kNexmonMagic = 0x1111;
inline constexpr std::size_t kNexmonHeaderBytes = 18;

inline bool has_nexmon_magic(std::span<const std::byte> payload) {
  return payload.size() >= 2 && ByteReader(payload).u16(0) == kNexmonMagic;
}

inline MacAddress nexmon_transmitter(const ByteReader& reader) {
  MacAddress mac;
  for (std::size_t i = 0; i < mac.octets.size(); ++i) {
    mac.octets[i] = reader.u8(4 + i);
  }
  return mac;
}

// REQUIRES: at least kNexmonHeaderBytes.
inline std::optional<RadioChannel> nexmon_channel(std::span<const std::byte> payload) {
  return channel_of_chanspec(ByteReader(payload).u16(14));
}

// Tones of a datagram of `size` bytes with `extra` bytes after the CSI, or 0: 64, 128 or 256.
constexpr std::size_t nexmon_tones(std::size_t size, std::size_t extra) {
  for (const std::size_t tones : {64U, 128U, 256U}) {
    if (size == kNexmonHeaderBytes + 4 * tones + extra) {
      return tones;
    }
  }
  return 0;
}

// 20 MHz for each 64 tones; these extractors do not support HE.
constexpr int nexmon_bandwidth_mhz(std::size_t tones) { return static_cast<int>(tones / 64 * 20); }

}  // namespace rayloc
