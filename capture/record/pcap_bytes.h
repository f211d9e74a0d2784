// Integers of capture files and packet headers: a given byte order at a given offset. The caller
// has checked that the bytes are present; a read past the end is a programming error and stops the
// program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/check.h"

namespace rayloc::pcap {

using Bytes = std::span<const std::byte>;

enum class ByteOrder { kLittle, kBig };

inline std::uint64_t load(Bytes bytes, std::size_t offset, std::size_t width, ByteOrder order) {
  RAYLOC_CHECK(offset <= bytes.size() && width <= bytes.size() - offset);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < width; ++i) {
    const std::size_t at = order == ByteOrder::kBig ? i : width - 1 - i;
    value = (value << 8) | std::to_integer<std::uint64_t>(bytes[offset + at]);
  }
  return value;
}
inline std::uint8_t load8(Bytes bytes, std::size_t offset) {
  return static_cast<std::uint8_t>(load(bytes, offset, 1, ByteOrder::kBig));
}
inline std::uint16_t load16(Bytes bytes, std::size_t offset, ByteOrder order = ByteOrder::kBig) {
  return static_cast<std::uint16_t>(load(bytes, offset, 2, order));
}
inline std::uint32_t load32(Bytes bytes, std::size_t offset, ByteOrder order = ByteOrder::kBig) {
  return static_cast<std::uint32_t>(load(bytes, offset, 4, order));
}
inline std::uint64_t load64(Bytes bytes, std::size_t offset, ByteOrder order = ByteOrder::kBig) {
  return load(bytes, offset, 8, order);
}

}  // namespace rayloc::pcap
