// Writes capture files and packets for tests: every variant that the reader must accept, byte by
// byte, sharing no code with it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rayloc::test {

using ByteString = std::string;  // bytes, not text

enum class Endian { kLittle, kBig };

ByteString u16(std::uint16_t value, Endian endian);
ByteString u32(std::uint32_t value, Endian endian);
ByteString u64(std::uint64_t value, Endian endian);

// --- packets (network byte order) ---

struct UdpPacket {
  std::uint32_t source_ip = 0x0a0a0a0a;
  std::uint32_t destination_ip = 0xffffffff;
  std::uint16_t source_port = 5500;
  std::uint16_t destination_port = 5500;
  ByteString payload = {};
  ByteString ip_options = {};       // a multiple of 4 bytes
  std::uint16_t fragment = 0x4000;  // flags and offset; 0x4000: don't fragment
  std::uint8_t protocol = 17;
  int udp_length_error = 0;  // added to the length in the UDP header
  int ip_length_error = 0;   // added to the length in the IP header
};
ByteString ipv4(const UdpPacket& packet);
ByteString ethernet(const ByteString& ip, std::uint16_t ether_type = 0x0800);
ByteString vlan_ethernet(const ByteString& ip, int tags);
ByteString linux_cooked(const ByteString& ip);
ByteString linux_cooked_v2(const ByteString& ip);
ByteString bsd_loopback(const ByteString& ip, Endian endian);

// --- classic pcap ---

ByteString pcap_header(Endian endian, bool nanoseconds, std::uint32_t link_type = 1);
// `fraction`: in the header's unit, microseconds or nanoseconds. `original` 0: the size of `data`.
ByteString pcap_record(Endian endian,
                       std::uint32_t seconds,
                       std::uint32_t fraction,
                       const ByteString& data,
                       std::uint32_t original = 0);

// --- pcapng ---

ByteString ng_block(Endian endian, std::uint32_t type, ByteString body);
ByteString ng_section(Endian endian);
ByteString ng_option(Endian endian, std::uint16_t code, ByteString value);
ByteString ng_interface(Endian endian,
                        std::uint16_t link_type,
                        const ByteString& options = {},
                        std::uint32_t snap_length = 0);
ByteString ng_enhanced(Endian endian,
                       std::uint32_t interface,
                       std::uint64_t ticks,
                       const ByteString& data);
ByteString ng_old_packet(Endian endian,
                         std::uint16_t interface,
                         std::uint64_t ticks,
                         const ByteString& data);
ByteString ng_simple(Endian endian, const ByteString& data);

// --- files ---

ByteString gzip(const ByteString& data);
void write_file(const std::string& path, const ByteString& data);
ByteString read_file(const std::string& path);
// A path in gtest's temporary folder, unique to this test program.
std::string temporary_path(const std::string& name);

}  // namespace rayloc::test
