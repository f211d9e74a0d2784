#include "engine/channel/mac_address.h"

#include <charconv>

namespace rayloc {
namespace {

// [characters], six pairs and five colons: "02:52:4c:00:00:01".
constexpr std::size_t kTextLength = 17;

}  // namespace

std::string to_string(const MacAddress& mac) {
  static constexpr std::string_view kDigits = "0123456789abcdef";  // base 16, in small letters
  std::string text;
  text.reserve(kTextLength);
  for (const std::uint8_t octet : mac.octets) {
    if (!text.empty()) {
      text += ':';
    }
    text += kDigits[octet >> 4U];
    text += kDigits[octet & 0xfU];
  }
  return text;
}

Expected<MacAddress> parse_mac_address(std::string_view text) {
  const auto refuse = [&] {
    return bad_input("'" + std::string(text) +
                     "' is not a MAC address; write six hexadecimal pairs, 02:52:4c:00:00:01");
  };
  if (text.size() != kTextLength) {
    return refuse();
  }
  MacAddress mac;
  for (std::size_t i = 0; i < mac.octets.size(); ++i) {
    const char* begin = text.data() + 3 * i;
    const auto [end, status] = std::from_chars(begin, begin + 2, mac.octets[i], 16);
    if (status != std::errc() || end != begin + 2) {
      return refuse();
    }
    if (i + 1 < mac.octets.size() && *end != ':' && *end != '-') {
      return refuse();
    }
  }
  return mac;
}

}  // namespace rayloc
