// AddressRange: the IPv4 addresses of a network, "192.168.1.0/24", or one of them, "192.168.1.7".
#pragma once

#include <cstdint>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

class AddressRange {
 public:
  // kUsage for an invalid text; also if bits after the prefix are set, since either the address or
  // the prefix is then wrong.
  static Expected<AddressRange> parse(const std::string& text);

  bool contains(std::uint32_t address) const { return (address & mask_) == network_; }

 private:
  AddressRange(std::uint32_t network, std::uint32_t mask) : network_(network), mask_(mask) {}

  std::uint32_t network_;  // in host order, as in DatagramAddress
  std::uint32_t mask_;
};

}  // namespace rayloc
