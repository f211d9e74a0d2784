// Datagram: one UDP datagram as received, with its addresses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/timestamp.h"

namespace rayloc {

// IPv4 addresses in host order. The default is that of an AX-CSI access point.
struct DatagramAddress {
  std::uint32_t source_ip = 0x0a0a0a0a;       // 10.10.10.10
  std::uint32_t destination_ip = 0xffffffff;  // broadcast
  std::uint16_t source_port = 5500;
  std::uint16_t destination_port = 5500;

  friend bool operator==(const DatagramAddress&, const DatagramAddress&) = default;
};

struct Datagram {
  // Arrival. Live sources truncate the kernel's stamp to microseconds, the resolution of the
  // recording, so that a replay of the recording gives the same event times.
  Timestamp time;
  DatagramAddress address;
  // The UDP payload; valid until the next read of the source that returned it.
  std::span<const std::byte> payload;
};

}  // namespace rayloc
