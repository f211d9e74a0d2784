#include "capture/record/pcap_format.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <span>

#include "capture/record/udp_packet.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

// WIRE_FORMATS 1.1: "NEXMON" sends broadcasts.
constexpr std::array<std::uint8_t, 14> kEthernetHeader = {
    0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x4e, 0x45, 0x58, 0x4d, 0x4f, 0x4e, 0x08, 0x00};

// Appends integers to a buffer: little-endian for the file, big-endian for the packet.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : out_(out) {}
  void little(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
      byte(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void big(std::uint64_t value, int bytes) {
    for (int i = bytes - 1; i >= 0; --i) {
      byte(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void byte(std::uint8_t value) { out_.push_back(std::byte{value}); }

 private:
  std::vector<std::byte>& out_;
};

// RFC 1071, over an even number of bytes or the last ones.
std::uint32_t ones_sum(std::span<const std::byte> bytes, std::uint32_t sum) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto value = std::to_integer<std::uint32_t>(bytes[i]);
    sum += i % 2 == 0 ? value << 8 : value;
  }
  while (sum > 0xffff) {
    sum = (sum & 0xffff) + (sum >> 16);
  }
  return sum;
}

void put16(std::vector<std::byte>& out, std::size_t offset, std::uint32_t value) {
  out[offset] = static_cast<std::byte>(value >> 8);
  out[offset + 1] = static_cast<std::byte>(value & 0xff);
}

void append_ipv4(const Datagram& datagram, std::vector<std::byte>& out) {
  const std::size_t udp_bytes = kUdpHeaderBytes + datagram.payload.size();
  const std::size_t ip_at = out.size();
  const DatagramAddress& address = datagram.address;
  Writer writer(out);
  writer.byte(0x45);
  writer.byte(0);
  writer.big(kIpv4HeaderBytes + udp_bytes, 2);
  writer.big(0x00004000, 4);  // identification 0, don't fragment
  writer.byte(64);            // time to live
  writer.byte(kProtocolUdp);
  writer.big(0, 2);
  writer.big(address.source_ip, 4);
  writer.big(address.destination_ip, 4);
  const std::size_t udp_at = out.size();
  writer.big(address.source_port, 2);
  writer.big(address.destination_port, 2);
  writer.big(udp_bytes, 2);
  writer.big(0, 2);
  out.insert(out.end(), datagram.payload.begin(), datagram.payload.end());

  const std::span<const std::byte> all(out);
  const std::uint32_t ip_sum = ones_sum(all.subspan(ip_at, kIpv4HeaderBytes), 0);
  // RFC 768: over the addresses, the protocol, the length, and the datagram.
  const auto pseudo_header = static_cast<std::uint32_t>(kProtocolUdp + udp_bytes);
  const std::uint32_t udp_sum =
      ones_sum(all.subspan(udp_at), ones_sum(all.subspan(ip_at + 12, 8), pseudo_header));
  put16(out, ip_at + 10, ~ip_sum & 0xffff);
  // 0 would indicate that the checksum is absent.
  put16(out, udp_at + 6, udp_sum == 0xffff ? 0xffff : ~udp_sum & 0xffff);
}

}  // namespace

std::vector<std::byte> pcap_file_header() {
  std::vector<std::byte> header;
  Writer out(header);
  out.little(0xa1b2c3d4, 4);  // microseconds
  out.little(2, 2);
  out.little(4, 2);
  out.little(0, 8);  // time zone and accuracy: always 0
  out.little(262144, 4);
  out.little(1, 4);  // LINKTYPE_ETHERNET
  return header;
}

bool append_pcap_record(const Datagram& datagram, std::vector<std::byte>& out) {
  RAYLOC_CHECK(datagram.payload.size() <= kMaxRecordedPayload);
  const auto time = std::chrono::floor<std::chrono::microseconds>(datagram.time);
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const std::int64_t s = seconds.time_since_epoch().count();
  if (s < 0 || s > std::numeric_limits<std::uint32_t>::max()) {
    return false;
  }
  const std::size_t length =
      kEthernetHeader.size() + kIpv4HeaderBytes + kUdpHeaderBytes + datagram.payload.size();
  Writer writer(out);
  writer.little(static_cast<std::uint64_t>(s), 4);
  writer.little(static_cast<std::uint64_t>((time - seconds).count()), 4);
  writer.little(length, 4);
  writer.little(length, 4);
  for (const std::uint8_t byte : kEthernetHeader) {
    writer.byte(byte);
  }
  append_ipv4(datagram, out);
  return true;
}

}  // namespace rayloc
