// MacAddress: an IEEE 802 address; printed in lower case with colons, as in every message.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "engine/base/expected.h"

namespace rayloc {

struct MacAddress {
  std::array<std::uint8_t, 6> octets{};

  friend auto operator<=>(const MacAddress&, const MacAddress&) = default;
};

// "02:52:4c:00:00:01"
std::string to_string(const MacAddress& mac);

// Accepts six hexadecimal pairs separated by ':' or '-', either case.
Expected<MacAddress> parse_mac_address(std::string_view text);

}  // namespace rayloc

template <>
struct std::hash<rayloc::MacAddress> {
  std::size_t operator()(const rayloc::MacAddress& mac) const noexcept {
    std::uint64_t value = 0;
    for (const std::uint8_t octet : mac.octets) {
      value = (value << 8U) | octet;
    }
    return static_cast<std::size_t>(value * 0x9e3779b97f4a7c15ULL);
  }
};
