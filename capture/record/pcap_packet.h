// From a captured packet to the UDP datagram in it.
//
// Link types: Ethernet (with 802.1Q/802.1ad tags), Linux cooked v1 and v2, raw IP, BSD loopback.
// MPLS labels and PPPoE sessions are passed like tags; other tunnels are rejected by their names
// (packet_tunnel.h). IPv4 with options. IPv6 is rejected: the access points' firmware speaks IPv4
// only, and so do DatagramAddress and the recorder. Checksums are not verified: the firmware sends
// none, and a capture on the sending machine is taken before the network card fills them in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tl/expected.hpp>

#include "capture/transport/datagram.h"

namespace rayloc::pcap {

// As the capture gives it.
struct Packet {
  std::optional<Timestamp> time;  // none in pcapng's simple packet blocks
  std::uint32_t link_type = 0;    // LINKTYPE_ of tcpdump.org/linktypes.html
  std::uint32_t original_length = 0;
  std::span<const std::byte> data;  // what was captured of it
};

constexpr std::uint32_t kLinkTypeNull = 0;
constexpr std::uint32_t kLinkTypeEthernet = 1;
constexpr std::uint32_t kLinkTypeRaw = 101;
constexpr std::uint32_t kLinkTypeLoop = 108;
constexpr std::uint32_t kLinkTypeLinuxSll = 113;
constexpr std::uint32_t kLinkTypeIpv4 = 228;
constexpr std::uint32_t kLinkTypeIpv6 = 229;
constexpr std::uint32_t kLinkTypeLinuxSll2 = 276;
// Of our own, beyond what a capture can name: a record of an Intel 5300 log, which is the payload.
constexpr std::uint32_t kLinkTypeIntel5300 = 0x10000;

// The datagram (its payload points into packet.data), or the reason why there is none:
// "no_timestamp", "link_type", "monitor_mode" (frames of the air), "not_udp", "ipv6",
// "ip_fragment", "bad_ip_header", "length_mismatch" (the lengths in the headers contradict each
// other or the packet), "truncated_capture" (the capture's snapshot length cut it), "wrong_port"
// (not `port`), or a tunnel ("tunnel_vxlan"). `through`: set to the name of a tunnel that was
// passed.
tl::expected<Datagram, const char*> udp_datagram(const Packet& packet,
                                                 std::optional<std::uint16_t> port,
                                                 const char** through = nullptr);

}  // namespace rayloc::pcap
