// Packets inside packets: what a mirror port, an overlay network or a VPN puts around the access
// point's datagrams. They are named, as the reason for which a packet is rejected ("tunnel_vxlan"),
// and not read.
#pragma once

#include <cstdint>

#include "capture/record/pcap_bytes.h"

namespace rayloc::pcap {

// Null when it is none that is known.
const char* tunnel_of_ether_type(std::uint16_t type);

// Of an IPv4 packet with that protocol; `payload` follows its header.
const char* tunnel_of_protocol(std::uint8_t protocol, Bytes payload);

// Of a UDP datagram, on whatever port: a tunnel's header and a packet behind it.
const char* tunnel_of_payload(Bytes payload);

}  // namespace rayloc::pcap
