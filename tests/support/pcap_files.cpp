#include "tests/support/pcap_files.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <fstream>
#include <iterator>

namespace rayloc::test {
namespace {

ByteString integer(std::uint64_t value, int width, Endian endian) {
  ByteString out;
  for (int i = 0; i < width; ++i) {
    const int shift = 8 * (endian == Endian::kBig ? width - 1 - i : i);
    out.push_back(static_cast<char>((value >> shift) & 0xffU));
  }
  return out;
}

ByteString net16(int value) { return u16(static_cast<std::uint16_t>(value), Endian::kBig); }
ByteString net32(std::uint32_t value) { return u32(value, Endian::kBig); }
ByteString zeros(std::size_t count) {
  ByteString bytes;
  bytes.resize(count);
  return bytes;
}
ByteString padded(ByteString data) {
  data.append((4 - data.size() % 4) % 4, '\0');
  return data;
}

}  // namespace

ByteString u16(std::uint16_t value, Endian endian) { return integer(value, 2, endian); }
ByteString u32(std::uint32_t value, Endian endian) { return integer(value, 4, endian); }
ByteString u64(std::uint64_t value, Endian endian) { return integer(value, 8, endian); }

ByteString ipv4(const UdpPacket& packet) {
  const int udp_length = static_cast<int>(packet.payload.size()) + 8;
  const int header = 20 + static_cast<int>(packet.ip_options.size());
  ByteString ip;
  ip.push_back(static_cast<char>(0x40 | (header / 4)));
  ip.push_back('\0');
  ip += net16(header + udp_length + packet.ip_length_error) + net16(0) + net16(packet.fragment);
  ip.push_back(static_cast<char>(64));
  ip.push_back(static_cast<char>(packet.protocol));
  ip += net16(0) + net32(packet.source_ip) + net32(packet.destination_ip) + packet.ip_options;
  ip += net16(packet.source_port) + net16(packet.destination_port) +
        net16(udp_length + packet.udp_length_error) + net16(0);
  return ip + packet.payload;
}

ByteString ethernet(const ByteString& ip, std::uint16_t ether_type) {
  return ByteString(6, '\xff') + "NEXMON" + net16(ether_type) + ip;
}

ByteString vlan_ethernet(const ByteString& ip, int tags) {
  ByteString tagged;
  for (int i = 0; i + 1 < tags; ++i) {
    tagged += net16(7) + net16(0x8100);
  }
  tagged += net16(42) + net16(0x0800) + ip;
  return ethernet(tagged, tags > 1 ? 0x88a8 : 0x8100);
}

ByteString linux_cooked(const ByteString& ip) {
  return net16(1) + net16(1) + net16(6) + "NEXMON" + zeros(2) + net16(0x0800) + ip;
}

ByteString linux_cooked_v2(const ByteString& ip) {
  return net16(0x0800) + zeros(2) + net32(3) + net16(1) + ByteString("\x01\x06", 2) + "NEXMON" +
         zeros(2) + ip;
}

ByteString bsd_loopback(const ByteString& ip, Endian endian) { return u32(2, endian) + ip; }

ByteString pcap_header(Endian endian, bool nanoseconds, std::uint32_t link_type) {
  return u32(nanoseconds ? 0xa1b23c4d : 0xa1b2c3d4, endian) + u16(2, endian) + u16(4, endian) +
         zeros(8) + u32(262144, endian) + u32(link_type, endian);
}

ByteString pcap_record(Endian endian,
                       std::uint32_t seconds,
                       std::uint32_t fraction,
                       const ByteString& data,
                       std::uint32_t original) {
  const auto size = static_cast<std::uint32_t>(data.size());
  return u32(seconds, endian) + u32(fraction, endian) + u32(size, endian) +
         u32(original == 0 ? size : original, endian) + data;
}

ByteString ng_block(Endian endian, std::uint32_t type, ByteString body) {
  body = padded(std::move(body));
  const ByteString length = u32(static_cast<std::uint32_t>(body.size() + 12), endian);
  return u32(type, endian) + length + body + length;
}

ByteString ng_section(Endian endian) {
  return ng_block(
      endian,
      0x0a0d0d0a,
      u32(0x1a2b3c4d, endian) + u16(1, endian) + u16(0, endian) + u64(0xffffffffffffffff, endian));
}

ByteString ng_option(Endian endian, std::uint16_t code, ByteString value) {
  const auto size = static_cast<std::uint16_t>(value.size());
  return u16(code, endian) + u16(size, endian) + padded(std::move(value));
}

ByteString ng_interface(Endian endian,
                        std::uint16_t link_type,
                        const ByteString& options,
                        std::uint32_t snap_length) {
  const ByteString end = options.empty() ? "" : zeros(4);
  return ng_block(
      endian, 1, u16(link_type, endian) + zeros(2) + u32(snap_length, endian) + options + end);
}

ByteString ng_enhanced(Endian endian,
                       std::uint32_t interface,
                       std::uint64_t ticks,
                       const ByteString& data) {
  const auto size = static_cast<std::uint32_t>(data.size());
  return ng_block(endian,
                  6,
                  u32(interface, endian) + u32(static_cast<std::uint32_t>(ticks >> 32), endian) +
                      u32(static_cast<std::uint32_t>(ticks), endian) + u32(size, endian) +
                      u32(size, endian) + data);
}

ByteString ng_old_packet(Endian endian,
                         std::uint16_t interface,
                         std::uint64_t ticks,
                         const ByteString& data) {
  const auto size = static_cast<std::uint32_t>(data.size());
  return ng_block(endian,
                  2,
                  u16(interface, endian) + u16(0, endian) +
                      u32(static_cast<std::uint32_t>(ticks >> 32), endian) +
                      u32(static_cast<std::uint32_t>(ticks), endian) + u32(size, endian) +
                      u32(size, endian) + data);
}

ByteString ng_simple(Endian endian, const ByteString& data) {
  return ng_block(endian, 3, u32(static_cast<std::uint32_t>(data.size()), endian) + data);
}

ByteString gzip(const ByteString& data) {
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  ByteString in = data;
  ByteString out(deflateBound(&stream, in.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  deflateEnd(&stream);
  return out;
}

void write_file(const std::string& path, const ByteString& data) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(data.data(), static_cast<std::streamsize>(data.size()));
  ASSERT_TRUE(out.good()) << path;
}

ByteString read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string temporary_path(const std::string& name) {
  return ::testing::TempDir() + "rayloc_" + std::to_string(getpid()) + "_" + name;
}

}  // namespace rayloc::test
