// Extracts the UDP datagram from a captured packet.
//
// Link types: Ethernet (with 802.1Q/802.1ad tags), Linux cooked v1 and v2, raw IP, BSD loopback.
// MPLS labels and PPPoE sessions are skipped like tags; other tunnels are rejected by their names
// (packet_tunnel.h). IPv4 with options. IPv6 is rejected: the access points' firmware uses IPv4
// only, and so do DatagramAddress and the recorder. Checksums are not verified: the firmware sends
// none, and a capture on the sending machine precedes their computation by the network card.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tl/expected.hpp>

#include "capture/transport/datagram.h"

namespace rayloc::pcap {

// A packet as the capture contains it.
struct Packet {
  std::optional<Timestamp> time;  // empty in pcapng's simple packet blocks
  std::uint32_t link_type = 0;    // LINKTYPE_ of tcpdump.org/linktypes.html
  std::uint32_t original_length = 0;
  std::span<const std::byte> data;  // the captured part
};

constexpr std::uint32_t kLinkTypeNull = 0;
constexpr std::uint32_t kLinkTypeEthernet = 1;
constexpr std::uint32_t kLinkTypeRaw = 101;
constexpr std::uint32_t kLinkTypeLoop = 108;
constexpr std::uint32_t kLinkTypeLinuxSll = 113;
constexpr std::uint32_t kLinkTypeIpv4 = 228;
constexpr std::uint32_t kLinkTypeIpv6 = 229;
constexpr std::uint32_t kLinkTypeLinuxSll2 = 276;
// Our own value, outside the range of captures: a record of an Intel 5300 log as the payload.
constexpr std::uint32_t kLinkTypeIntel5300 = 0x10000;

// Returns the datagram (its payload points into packet.data), or the reason for its absence:
// "no_timestamp", "link_type", "monitor_mode" (frames of the air), "not_udp", "ipv6",
// "ip_fragment", "bad_ip_header", "length_mismatch" (the lengths in the headers contradict each
// other or the packet), "truncated_capture" (the capture's snapshot length cut it), "wrong_port"
// (not `port`), or a tunnel ("tunnel_vxlan"). `through`: set to the name of a tunnel that was
// skipped.
tl::expected<Datagram, const char*> udp_datagram(const Packet& packet,
                                                 std::optional<std::uint16_t> port,
                                                 const char** through = nullptr);

}  // namespace rayloc::pcap
