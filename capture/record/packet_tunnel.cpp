#include "capture/record/packet_tunnel.h"

namespace rayloc::pcap {
namespace {

constexpr std::uint16_t kEtherTypeBridging = 0x6558;  // Ethernet in GRE and GENEVE
constexpr std::uint16_t kTypeIpv4 = 0x0800;
constexpr std::uint16_t kTypeIpv6 = 0x86dd;

bool is_ip(Bytes bytes) {
  const unsigned version = bytes.empty() ? 0U : load8(bytes, 0) >> 4;
  return version == 4 || version == 6;
}

// True if the EtherType is one that networks carry; `tags`: VLAN tags in front of it.
bool is_ethernet_frame(Bytes frame) {
  constexpr std::uint16_t kTypeVlan = 0x8100;
  constexpr std::uint16_t kTypeServiceVlan = 0x88a8;
  std::size_t at = 12;
  while (frame.size() >= at + 2) {
    const std::uint16_t type = load16(frame, at);
    if (type == kTypeIpv4 || type == kTypeIpv6) {
      return is_ip(frame.subspan(at + 2));
    }
    if (type != kTypeVlan && type != kTypeServiceVlan) {
      return false;
    }
    at += 4;
  }
  return false;
}

// Flags with a network identifier only, and reserved bytes that are zero.
bool is_vxlan(Bytes payload) {
  constexpr std::size_t kHeaderBytes = 8;
  return payload.size() > kHeaderBytes && load32(payload, 0) == 0x08000000 &&
         load8(payload, 7) == 0 && is_ethernet_frame(payload.subspan(kHeaderBytes));
}

bool is_geneve(Bytes payload) {
  constexpr std::size_t kHeaderBytes = 8;
  if (payload.size() <= kHeaderBytes || (load8(payload, 0) & 0xc0U) != 0 ||
      (load8(payload, 1) & 0x3fU) != 0 || load8(payload, 7) != 0) {
    return false;
  }
  const std::size_t begin = kHeaderBytes + (load8(payload, 0) & 0x3fU) * std::size_t{4};
  if (payload.size() <= begin) {
    return false;
  }
  const std::uint16_t type = load16(payload, 2);
  return type == kEtherTypeBridging
             ? is_ethernet_frame(payload.subspan(begin))
             : (type == kTypeIpv4 || type == kTypeIpv6) && is_ip(payload.subspan(begin));
}

// Version 1, type received packet or packet for transmission, Ethernet, tagged fields, end tag.
bool is_tzsp(Bytes payload) {
  constexpr std::size_t kHeaderBytes = 4;
  constexpr std::uint8_t kPadding = 0;
  constexpr std::uint8_t kEnd = 1;
  constexpr std::uint16_t kEthernet = 1;
  if (payload.size() <= kHeaderBytes || load8(payload, 0) != 1 || load8(payload, 1) > 1 ||
      load16(payload, 2) != kEthernet) {
    return false;
  }
  std::size_t at = kHeaderBytes;
  while (at + 1 < payload.size() && load8(payload, at) != kEnd) {
    at += load8(payload, at) == kPadding ? std::size_t{1} : std::size_t{2} + load8(payload, at + 1);
  }
  return at < payload.size() && is_ethernet_frame(payload.subspan(at + 1));
}

}  // namespace

const char* tunnel_of_ether_type(std::uint16_t type) {
  switch (type) {
    case 0x4305:
      return "tunnel_batman";
    case 0x88e5:
      return "tunnel_macsec";
    case 0x88e7:
      return "tunnel_mac_in_mac";
    default:
      return nullptr;
  }
}

const char* tunnel_of_protocol(std::uint8_t protocol, Bytes payload) {
  constexpr std::uint8_t kGre = 47;
  if (protocol == kGre) {
    const std::uint16_t type = payload.size() < 4 ? std::uint16_t{0} : load16(payload, 2);
    return type == 0x88be || type == 0x22eb ? "tunnel_erspan" : "tunnel_gre";
  }
  switch (protocol) {
    case 4:
      return "tunnel_ipip";
    case 41:
      return "tunnel_6in4";
    case 50:
    case 51:
      return "tunnel_ipsec";
    case 97:
      return "tunnel_etherip";
    case 115:
      return "tunnel_l2tp";
    case 137:
      return "tunnel_mpls";
    default:
      return nullptr;
  }
}

const char* tunnel_of_payload(Bytes payload) {
  if (is_vxlan(payload)) {
    return "tunnel_vxlan";
  }
  if (is_geneve(payload)) {
    return "tunnel_geneve";
  }
  return is_tzsp(payload) ? "tunnel_tzsp" : nullptr;
}

}  // namespace rayloc::pcap
