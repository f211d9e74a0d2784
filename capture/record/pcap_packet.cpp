#include "capture/record/pcap_packet.h"

#include <algorithm>
#include <array>

#include "capture/record/packet_tunnel.h"
#include "capture/record/pcap_bytes.h"
#include "capture/record/udp_packet.h"

namespace rayloc::pcap {
namespace {

// Link types of raw IP in old files: DLT_RAW of BSD and of OpenBSD.
constexpr std::uint32_t kDltRaw = 12;
constexpr std::uint32_t kDltRawOpenBsd = 14;
constexpr std::uint32_t kLinkTypePppoe = 51;  // LINKTYPE_PPP_ETHER

// Link types of monitor mode: 802.11 frames, bare or behind a header of the radio.
constexpr std::array<std::uint32_t, 5> kMonitorModes = {
    105,  // IEEE802_11
    119,  // IEEE802_11_PRISM
    127,  // IEEE802_11_RADIOTAP
    163,  // IEEE802_11_AVS
    192,  // PPI
};

constexpr std::uint16_t kEtherTypeIpv4 = 0x0800;
constexpr std::uint16_t kEtherTypeIpv6 = 0x86dd;
constexpr std::uint16_t kEtherTypeVlan = 0x8100;         // 802.1Q
constexpr std::uint16_t kEtherTypeServiceVlan = 0x88a8;  // 802.1ad
constexpr std::uint16_t kEtherTypeOldQinq = 0x9100;
constexpr std::uint16_t kEtherTypeMpls = 0x8847;
constexpr std::uint16_t kEtherTypeMplsUpstream = 0x8848;
constexpr std::uint16_t kEtherTypePppoe = 0x8864;  // sessions; discovery has another one
constexpr std::size_t kVlanTagBytes = 4;

constexpr std::uint32_t kFamilyIpv4 = 2;  // AF_INET is 2 on every system that writes such files

using Refusal = tl::unexpected<const char*>;

Refusal refuse(const char* reason) { return Refusal(reason); }

// Bytes stated in a header are missing: cut by the capture, or never sent.
Refusal too_short(const Packet& packet) {
  return refuse(packet.data.size() < packet.original_length ? "truncated_capture"
                                                            : "length_mismatch");
}

bool is_monitor_mode(std::uint32_t link_type) {
  return std::find(kMonitorModes.begin(), kMonitorModes.end(), link_type) != kMonitorModes.end();
}

bool is_vlan(std::uint16_t ether_type) {
  return ether_type == kEtherTypeVlan || ether_type == kEtherTypeServiceVlan ||
         ether_type == kEtherTypeOldQinq;
}

// The payload of the link layer.
struct Carried {
  Bytes ip;
  const char* through = nullptr;  // name of a tunnel
};
using Link = tl::expected<Carried, const char*>;

// Skips the labels, the last of which is marked.
Link after_mpls(const Packet& packet, Bytes labels) {
  constexpr std::size_t kLabelBytes = 4;
  bool last = false;
  while (!last) {
    if (labels.size() < kLabelBytes) {
      return too_short(packet);
    }
    last = (load8(labels, 2) & 1U) != 0;
    labels = labels.subspan(kLabelBytes);
  }
  if (labels.empty()) {
    return too_short(packet);
  }
  const unsigned version = load8(labels, 0) >> 4;
  if (version != 4 && version != 6) {  // a pseudowire: frames of another link layer
    return refuse("tunnel_mpls");
  }
  return Carried{labels, "MPLS"};
}

Link after_pppoe(const Packet& packet, Bytes session) {
  constexpr std::size_t kHeaderBytes = 8;  // including PPP's two
  constexpr std::uint16_t kPppIpv4 = 0x0021;
  constexpr std::uint16_t kPppIpv6 = 0x0057;
  if (session.size() < kHeaderBytes) {
    return too_short(packet);
  }
  const std::uint16_t protocol = load16(session, 6);
  if (protocol == kPppIpv4) {
    return Carried{session.subspan(kHeaderBytes), "PPPoE"};
  }
  return refuse(protocol == kPppIpv6 ? "ipv6" : "not_udp");
}

// Skips VLAN tags; `ip` begins after the EtherType `type`.
Link after_ether_type(const Packet& packet, std::uint16_t type, Bytes ip) {
  while (is_vlan(type)) {
    if (ip.size() < kVlanTagBytes) {
      return too_short(packet);
    }
    type = load16(ip, 2);
    ip = ip.subspan(kVlanTagBytes);
  }
  if (type == kEtherTypeIpv6) {
    return refuse("ipv6");
  }
  if (type == kEtherTypeMpls || type == kEtherTypeMplsUpstream) {
    return after_mpls(packet, ip);
  }
  if (type == kEtherTypePppoe) {
    return after_pppoe(packet, ip);
  }
  if (type != kEtherTypeIpv4) {
    const char* const tunnel = tunnel_of_ether_type(type);
    return refuse(tunnel != nullptr ? tunnel : "not_udp");
  }
  return Carried{ip};
}

// The link layer's header is `header` bytes long and has the EtherType at `type_offset`.
Link after_header(const Packet& packet, std::size_t header, std::size_t type_offset) {
  if (packet.data.size() < header) {
    return too_short(packet);
  }
  return after_ether_type(packet, load16(packet.data, type_offset), packet.data.subspan(header));
}

// The address family is in the byte order of the capturing machine: either of the two.
Link after_family(const Packet& packet) {
  constexpr std::size_t kFamilyBytes = 4;
  if (packet.data.size() < kFamilyBytes) {
    return too_short(packet);
  }
  const std::uint32_t big = load32(packet.data, 0, ByteOrder::kBig);
  const std::uint32_t little = load32(packet.data, 0, ByteOrder::kLittle);
  if (big != kFamilyIpv4 && little != kFamilyIpv4) {
    return refuse("not_udp");
  }
  return Carried{packet.data.subspan(kFamilyBytes)};
}

Link after_link_layer(const Packet& packet) {
  switch (packet.link_type) {
    case kLinkTypeEthernet:
      return after_header(packet, 14, 12);
    case kLinkTypeLinuxSll:
      return after_header(packet, 16, 14);
    case kLinkTypeLinuxSll2:
      return after_header(packet, 20, 0);
    case kLinkTypeNull:
    case kLinkTypeLoop:
      return after_family(packet);
    case kLinkTypeRaw:
    case kDltRaw:
    case kDltRawOpenBsd:
    case kLinkTypeIpv4:
      return Carried{packet.data};
    case kLinkTypePppoe:
      return after_pppoe(packet, packet.data);
    case kLinkTypeIpv6:
      return refuse("ipv6");
    default:
      return refuse(is_monitor_mode(packet.link_type) ? "monitor_mode" : "link_type");
  }
}

// Checks the IPv4 header, stores the addresses and returns the bytes after it.
tl::expected<Bytes, const char*> after_ipv4(const Packet& packet,
                                            Bytes ip,
                                            DatagramAddress& address) {
  if (ip.empty()) {
    return too_short(packet);
  }
  const unsigned version = load8(ip, 0) >> 4;
  if (version == 6) {
    return refuse("ipv6");
  }
  const std::size_t header = (load8(ip, 0) & 0x0fU) * std::size_t{4};
  if (version != 4 || header < kIpv4HeaderBytes) {
    return refuse("bad_ip_header");
  }
  if (ip.size() < header) {
    return too_short(packet);
  }
  // More fragments follow, or this is not the first one.
  if ((load16(ip, 6) & 0x3fffU) != 0) {
    return refuse("ip_fragment");
  }
  if (load8(ip, 9) != kProtocolUdp) {
    const char* const tunnel = tunnel_of_protocol(load8(ip, 9), ip.subspan(header));
    return refuse(tunnel != nullptr ? tunnel : "not_udp");
  }
  const std::size_t total = load16(ip, 2);
  if (total < header + kUdpHeaderBytes) {
    return refuse("length_mismatch");
  }
  if (ip.size() < total) {
    return too_short(packet);
  }
  address.source_ip = load32(ip, 12);
  address.destination_ip = load32(ip, 16);
  // The bytes after it are the link layer's padding or frame check sequence.
  return ip.subspan(header, total - header);
}

}  // namespace

tl::expected<Datagram, const char*> udp_datagram(const Packet& packet,
                                                 std::optional<std::uint16_t> port,
                                                 const char** through) {
  if (!packet.time) {
    return refuse("no_timestamp");
  }
  if (packet.link_type == kLinkTypeIntel5300) {  // written by the card, not received from a network
    return Datagram{*packet.time, {}, packet.data};
  }
  const Link link = after_link_layer(packet);
  RAYLOC_TRY(link);
  Datagram datagram;
  datagram.time = *packet.time;
  const auto udp = after_ipv4(packet, link->ip, datagram.address);
  RAYLOC_TRY(udp);
  datagram.address.source_port = load16(*udp, 0);
  datagram.address.destination_port = load16(*udp, 2);
  if (port && datagram.address.destination_port != *port) {
    return refuse("wrong_port");
  }
  // As in the kernel: the IP payload may be longer than the datagram, never shorter.
  const std::size_t length = load16(*udp, 4);
  if (length < kUdpHeaderBytes || length > udp->size()) {
    return refuse("length_mismatch");
  }
  datagram.payload = udp->subspan(kUdpHeaderBytes, length - kUdpHeaderBytes);
  if (const char* const tunnel = tunnel_of_payload(datagram.payload)) {
    return refuse(tunnel);
  }
  if (through != nullptr) {
    *through = link->through;
  }
  return datagram;
}

}  // namespace rayloc::pcap
