// Captures of mirror ports, overlay networks and paths with a small MTU, and captures that cut
// packets: each is named, with what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pcap_files.h"
#include "tests/support/recording_answer.h"

namespace rayloc::field_tunnels_test {
namespace {

using test::ByteString;
using test::Endian;
using test::ethernet;
using test::ipv4;
using test::read_as_file;
using test::RecordingAnswer;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Counts = std::map<std::string, std::uint64_t>;

ByteString bytes(std::initializer_list<unsigned> values) {
  ByteString out;
  for (const unsigned value : values) {
    out.push_back(static_cast<char>(value));
  }
  return out;
}

ByteString datagram() { return ipv4({.payload = ByteString(100, 'c')}); }

// An IPv4 packet of another protocol than UDP.
ByteString of_protocol(std::uint8_t protocol, const ByteString& payload) {
  ByteString packet = ipv4({.payload = payload.substr(8), .protocol = protocol});
  return packet.replace(20, 8, payload.substr(0, 8));
}

ByteString in_udp(std::uint16_t port, const ByteString& payload) {
  return ethernet(ipv4({.destination_port = port, .payload = payload}));
}

ByteString capture(const std::vector<ByteString>& packets,
                   std::size_t snap_length = 65535,
                   std::uint32_t link_type = 1) {
  ByteString file = test::pcap_header(Endian::kLittle, false, link_type);
  std::uint32_t microseconds = 0;
  for (const ByteString& packet : packets) {
    file += test::pcap_record(Endian::kLittle,
                              1'718'001'352,
                              ++microseconds,
                              packet.substr(0, snap_length),
                              static_cast<std::uint32_t>(packet.size()));
  }
  return file;
}

TEST(Field, ATunnelIsNamed) {
  const ByteString inner = ethernet(datagram());
  const ByteString tagged = test::vlan_ethernet(datagram(), 2);
  const ByteString vxlan = bytes({8, 0, 0, 0, 0, 0, 42, 0});
  const ByteString geneve = bytes({0, 0, 0x65, 0x58, 0, 0, 1, 0});
  const ByteString geneve_options = bytes({2, 0, 0x65, 0x58, 0, 0, 1, 0}) + ByteString(8, 'o');
  const ByteString tzsp = bytes({1, 0, 0, 1, 10, 1, 0xc4, 0, 1});
  const std::vector<std::tuple<std::string, std::string, ByteString>> cases = {
      {"tunnel_vxlan", "VXLAN", in_udp(4789, vxlan + inner)},
      {"tunnel_vxlan", "VXLAN", in_udp(8472, vxlan + tagged)},
      {"tunnel_geneve", "GENEVE", in_udp(6081, geneve + inner)},
      {"tunnel_geneve", "GENEVE", in_udp(6081, geneve_options + inner)},
      {"tunnel_tzsp", "TZSP", in_udp(37008, tzsp + inner)},
      {"tunnel_erspan",
       "ERSPAN",
       ethernet(of_protocol(47, bytes({0x10, 0, 0x88, 0xbe}) + ByteString(12, 0) + inner))},
      {"tunnel_erspan",
       "ERSPAN",
       ethernet(of_protocol(47, bytes({0x10, 0, 0x22, 0xeb}) + ByteString(16, 0) + inner))},
      {"tunnel_gre", "GRE", ethernet(of_protocol(47, bytes({0, 0, 8, 0}) + datagram()))},
      {"tunnel_ipip", "IP in IP", ethernet(of_protocol(4, datagram()))},
      {"tunnel_6in4", "6in4", ethernet(of_protocol(41, ByteString(60, 0x60)))},
      {"tunnel_ipsec", "IPsec", ethernet(of_protocol(50, ByteString(60, 'e')))},
      {"tunnel_macsec", "MACsec", ethernet(datagram(), 0x88e5)},
      {"tunnel_mpls", "MPLS", ethernet(bytes({0, 0x10, 1, 64, 0, 0, 0, 0}) + inner, 0x8847)}};
  for (const auto& [reason, name, packet] : cases) {
    const RecordingAnswer given = read_as_file(capture({packet, packet}));
    EXPECT_EQ(given.counters.rejected, (Counts{{reason, 2}}));
    EXPECT_THAT(given.words,
                ElementsAre(AllOf(HasSubstr("2 of 2 packets came through a tunnel"),
                                  HasSubstr(name),
                                  HasSubstr("own interface"))))
        << reason;
  }
}

TEST(Field, DatagramsInMplsAndPppoeAreReadAndTheTunnelIsNoted) {
  const ByteString labels = bytes({0, 0x10, 0x10, 64, 0, 0x20, 0x11, 64});
  const ByteString session =
      bytes({0x11, 0, 0, 7, 0, static_cast<unsigned>(datagram().size() + 2), 0, 0x21}) + datagram();
  const std::vector<std::tuple<std::string, ByteString, std::uint32_t>> cases = {
      {"MPLS", ethernet(labels + datagram(), 0x8847), 1},
      {"MPLS", ethernet(labels.substr(4) + datagram(), 0x8848), 1},
      {"PPPoE", ethernet(session, 0x8864), 1},
      {"PPPoE", session, 51}};
  for (const auto& [name, packet, link_type] : cases) {
    const RecordingAnswer given = read_as_file(capture({packet, packet}, 65535, link_type));
    EXPECT_THAT(given.payloads, ElementsAre(ByteString(100, 'c'), ByteString(100, 'c')));
    EXPECT_THAT(given.words, ElementsAre(AllOf(HasSubstr("2 datagrams"), HasSubstr(name))));
  }
  for (std::size_t size = 0; size < 40; ++size) {  // whatever a snapshot length leaves of them
    for (const auto& [name, packet, link_type] : cases) {
      EXPECT_EQ(read_as_file(capture({packet}, size, link_type)).counters.rejected,
                (Counts{{"truncated_capture", 1}}));
    }
  }
}

// Another program's tunnel beside many datagrams of an access point is no fault of the capture.
TEST(Field, ATunnelOfAnotherProgramIsCountedOnly) {
  std::vector<ByteString> packets(30, ethernet(datagram()));
  packets.push_back(ethernet(of_protocol(50, ByteString(60, 'e'))));
  packets.push_back(ethernet(ipv4({.payload = "x", .fragment = 0x2000})));
  const RecordingAnswer given = read_as_file(capture(packets));
  EXPECT_EQ(given.counters.rejected, (Counts{{"ip_fragment", 1}, {"tunnel_ipsec", 1}}));
  EXPECT_EQ(given.payloads.size(), 30U);
  EXPECT_THAT(given.words, IsEmpty());
}

TEST(Field, IpFragmentsYieldAdviceOnTheMtu) {
  const ByteString first = ethernet(ipv4({.payload = ByteString(64, 'x'), .fragment = 0x2000}));
  const ByteString second = ethernet(ipv4({.payload = ByteString(30, 'x'), .fragment = 9}));
  const RecordingAnswer given = read_as_file(capture({first, second}));
  EXPECT_EQ(given.counters.rejected, (Counts{{"ip_fragment", 2}}));
  EXPECT_THAT(given.words, ElementsAre(AllOf(HasSubstr("fragments"), HasSubstr("MTU"))));
}

TEST(Field, TruncatedCapturesYieldCountsAndAdviceOnCapturing) {
  const ByteString longer = ethernet(ipv4({.payload = ByteString(500, 'x')}));
  const ByteString shorter = ethernet(ipv4({.payload = ByteString(20, 'x')}));
  const RecordingAnswer given = read_as_file(capture({longer, shorter, longer}, 96));
  EXPECT_EQ(given.payloads.size(), 1U);
  EXPECT_THAT(given.words,
              ElementsAre(AllOf(HasSubstr("2 of 3 packets"), HasSubstr("tcpdump -s 0")),
                          HasSubstr("96 of " + std::to_string(longer.size()) + " bytes")));
}

}  // namespace
}  // namespace rayloc::field_tunnels_test
