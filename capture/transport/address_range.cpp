#include "capture/transport/address_range.h"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <optional>

namespace rayloc {
namespace {

constexpr int kBits = 32;

std::optional<int> parse_prefix(const std::string& text) {
  int prefix = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, prefix);
  return parsed.ec == std::errc() && parsed.ptr == end && prefix >= 0 && prefix <= kBits
             ? std::optional(prefix)
             : std::nullopt;
}

std::string to_text(std::uint32_t address) {
  const in_addr network{htonl(address)};
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &network, text.data(), text.size());
  return text.data();
}

}  // namespace

Expected<AddressRange> AddressRange::parse(const std::string& text) {
  const std::size_t slash = text.find('/');
  const bool whole = slash == std::string::npos;
  const std::optional<int> prefix = whole ? kBits : parse_prefix(text.substr(slash + 1));
  in_addr parsed{};
  if (!prefix || inet_pton(AF_INET, text.substr(0, slash).c_str(), &parsed) != 1) {
    return make_error(ErrorKind::kUsage,
                      "'" + text +
                          "' is no IPv4 address and no network; write, for example, 192.168.1.7 "
                          "or 192.168.1.0/24");
  }
  const std::uint32_t address = ntohl(parsed.s_addr);
  // Shifting by all 32 bits is undefined.
  const std::uint32_t mask = *prefix == 0 ? 0 : ~std::uint32_t{0} << (kBits - *prefix);
  if ((address & mask) != address) {
    return make_error(ErrorKind::kUsage,
                      "'" + text + "' is an address in a network; write " + to_text(address) +
                          " for the one, " + to_text(address & mask) + "/" +
                          std::to_string(*prefix) + " for the other");
  }
  return AddressRange(address, mask);
}

}  // namespace rayloc
