// Packets inside packets: headers that a mirror port, an overlay network or a VPN adds around the
// access point's datagrams. Tunnels are named, as the reason for which a packet is rejected
// ("tunnel_vxlan"), and not decoded.
#pragma once

#include <cstdint>

#include "capture/record/pcap_bytes.h"

namespace rayloc::pcap {

// Returns the tunnel's name, or null if the type is not in the table.
const char* tunnel_of_ether_type(std::uint16_t type);

// For an IPv4 packet with that protocol; `payload` follows its header.
const char* tunnel_of_protocol(std::uint8_t protocol, Bytes payload);

// For a UDP datagram, on any port: a tunnel's header and a packet behind it.
const char* tunnel_of_payload(Bytes payload);

}  // namespace rayloc::pcap
