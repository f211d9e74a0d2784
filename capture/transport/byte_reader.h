// ByteReader: little-endian reads at byte offsets of a datagram; the only access to its bytes.
//
// A decoder checks the length before it reads, so a read outside is a programming error and stops
// the program instead of returning a neighbour's bytes. Alignment and the byte order of the host do
// not matter.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "engine/base/check.h"

namespace rayloc {

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t size() const { return bytes_.size(); }

  std::uint8_t u8(std::size_t offset) const { return load<std::uint8_t>(offset); }
  std::int8_t i8(std::size_t offset) const { return static_cast<std::int8_t>(u8(offset)); }
  std::uint16_t u16(std::size_t offset) const {
    const auto value = load<std::uint16_t>(offset);
    if constexpr (std::endian::native == std::endian::big) {
      return static_cast<std::uint16_t>(__builtin_bswap16(value));
    }
    return value;
  }
  std::uint32_t u32(std::size_t offset) const {
    const auto value = load<std::uint32_t>(offset);
    if constexpr (std::endian::native == std::endian::big) {
      return __builtin_bswap32(value);
    }
    return value;
  }
  std::uint64_t u48(std::size_t offset) const {
    return u32(offset) | static_cast<std::uint64_t>(u16(offset + 4)) << 32U;
  }
  std::uint64_t u64(std::size_t offset) const {
    return u32(offset) | static_cast<std::uint64_t>(u32(offset + 4)) << 32U;
  }

  // REQUIRES: offset + count <= size().
  std::span<const std::byte> bytes(std::size_t offset, std::size_t count) const {
    RAYLOC_CHECK(offset <= bytes_.size() && count <= bytes_.size() - offset);
    return bytes_.subspan(offset, count);
  }

 private:
  template <typename T>
  T load(std::size_t offset) const {
    RAYLOC_CHECK(offset <= bytes_.size() && sizeof(T) <= bytes_.size() - offset);
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof(T));
    return value;
  }

  std::span<const std::byte> bytes_;
};

}  // namespace rayloc
