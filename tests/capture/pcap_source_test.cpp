// Every kind of capture file that PcapFileSource must read, written byte by byte by
// tests/support/pcap_files.h.
#include "capture/source/pcap_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <numeric>

#include "tests/support/pcap_files.h"

namespace rayloc::pcap_source_test {
namespace {

using test::ByteString;
using test::Endian;
using test::ethernet;
using test::ipv4;
using test::pcap_header;
using test::pcap_record;
using ::testing::HasSubstr;

constexpr std::array kEndians = {Endian::kLittle, Endian::kBig};
constexpr std::uint32_t kSecond = 1525500671;  // that of the golden datagram of WIRE_FORMATS 1.1

Timestamp at(std::int64_t seconds, std::int64_t nanoseconds) {
  return Timestamp(std::chrono::seconds(seconds) + Duration(nanoseconds));
}

struct ReadDatagram {
  Timestamp time;
  DatagramAddress address;
  ByteString payload;
};

struct Reading {
  std::vector<ReadDatagram> datagrams;
  SourceCounters counters;
  Timestamp watermark;
  std::string error;
  std::string warning;
};

std::uint64_t sum(const std::map<std::string, std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}, [](auto n, const auto& c) {
    return n + c.second;
  });
}

// Reads to the end or the error, and checks what every source promises.
Reading read_all(const std::string& path, const PcapFileOptions& options = {}) {
  Reading reading;
  auto source = PcapFileSource::open(path, options);
  if (!source) {
    reading.error = source.error().message;
    return reading;
  }
  DatagramBatch batch;
  Timestamp watermark = Timestamp::min();
  while (!batch.ended) {
    const auto read = (*source)->read(batch, std::chrono::seconds(1));
    if (!read) {
      reading.error = read.error().message;
      break;
    }
    for (const Datagram& d : batch.datagrams) {
      EXPECT_GE(d.time, watermark);
      const auto* bytes = reinterpret_cast<const char*>(d.payload.data());
      reading.datagrams.push_back({d.time, d.address, ByteString(bytes, d.payload.size())});
    }
    EXPECT_GE(batch.watermark, watermark);
    watermark = batch.watermark;
  }
  reading.counters = (*source)->counters();
  for (const std::string& line : (*source)->warnings()) {
    reading.warning += line;
  }
  reading.watermark = watermark;
  EXPECT_EQ(reading.counters.delivered, reading.datagrams.size());
  EXPECT_EQ(reading.counters.received, reading.counters.delivered + sum(reading.counters.rejected));
  return reading;
}

Reading read_bytes(const ByteString& file, const PcapFileOptions& options = {}) {
  const std::string path = test::temporary_path("pcap_source_test");
  test::write_file(path, file);
  Reading reading = read_all(path, options);
  unlink(path.c_str());
  return reading;
}

ByteString udp(const ByteString& payload) { return ipv4({.payload = payload}); }

TEST(PcapFileSource, ReadsClassicFilesOfBothByteOrdersAndResolutions) {
  for (const Endian endian : kEndians) {
    for (const bool nanoseconds : {false, true}) {
      const ByteString file =
          pcap_header(endian, nanoseconds) +
          pcap_record(endian, kSecond, 306626, ethernet(udp("first"))) +
          pcap_record(endian, kSecond + 1, 0, ethernet(udp("second, of another length")));
      const Reading reading = read_bytes(file);
      ASSERT_EQ(reading.error, "");
      ASSERT_EQ(reading.datagrams.size(), 2U);
      EXPECT_EQ(reading.datagrams[0].time, at(kSecond, nanoseconds ? 306626 : 306626000));
      EXPECT_EQ(reading.datagrams[1].time, at(kSecond + 1, 0));
      EXPECT_EQ(reading.datagrams[0].payload, "first");
      EXPECT_EQ(reading.datagrams[1].payload, "second, of another length");
      EXPECT_EQ(reading.counters.bytes, 30U);
      EXPECT_EQ(reading.watermark, Timestamp::max());
    }
  }
}

TEST(PcapFileSource, GivesTheAddressesInHostOrder) {
  const ByteString packet = ipv4({.source_ip = 0xc0a80117,
                                  .destination_ip = 0x7f000001,
                                  .source_port = 1234,
                                  .destination_port = 5501,
                                  .payload = "x"});
  const Reading reading = read_bytes(pcap_header(Endian::kLittle, false) +
                                     pcap_record(Endian::kLittle, 1, 0, ethernet(packet)));
  ASSERT_EQ(reading.datagrams.size(), 1U);
  EXPECT_EQ(reading.datagrams[0].address,
            (DatagramAddress{.source_ip = 0xc0a80117,
                             .destination_ip = 0x7f000001,
                             .source_port = 1234,
                             .destination_port = 5501}));
}

ByteString classic(const std::vector<ByteString>& packets, std::uint32_t link_type = 1) {
  ByteString file = pcap_header(Endian::kLittle, false, link_type);
  for (const ByteString& packet : packets) {
    file += pcap_record(Endian::kLittle, kSecond, 0, packet);
  }
  return file;
}

TEST(PcapFileSource, ReadsPcapngInterfacesWithTheirOwnLinkTypesAndClocks) {
  for (const Endian endian : kEndians) {
    const ByteString nanoseconds = test::ng_option(endian, 9, ByteString(1, '\x09'));
    // 2^-10 s, 100 s to be added.
    const ByteString binary = test::ng_option(endian, 9, ByteString(1, '\x8a')) +
                              test::ng_option(endian, 2, "name of the interface") +
                              test::ng_option(endian, 14, test::u64(100, endian));
    const ByteString file =
        test::ng_section(endian) + test::ng_interface(endian, 1) +
        test::ng_interface(endian, 101, nanoseconds) +
        test::ng_block(endian, 5, ByteString(20, '\0')) +  // interface statistics
        test::ng_enhanced(endian, 0, kSecond * 1'000'000ULL + 306626, ethernet(udp("a"))) +
        test::ng_enhanced(endian, 1, kSecond * 1'000'000'000ULL + 306626001, udp("bcd")) +
        test::ng_interface(endian, 113, binary) +
        test::ng_enhanced(
            endian, 2, (kSecond - 100) * 1024ULL + 512, test::linux_cooked(udp("efghi"))) +
        test::ng_old_packet(endian, 0, kSecond * 1'000'000ULL + 600000, ethernet(udp("j"))) +
        test::ng_simple(endian, ethernet(udp("k")));
    const Reading reading = read_bytes(file);
    ASSERT_EQ(reading.error, "");
    ASSERT_EQ(reading.datagrams.size(), 4U);
    EXPECT_EQ(reading.datagrams[0].time, at(kSecond, 306626000));
    EXPECT_EQ(reading.datagrams[1].time, at(kSecond, 306626001));
    EXPECT_EQ(reading.datagrams[2].time, at(kSecond, 500000000));
    EXPECT_EQ(reading.datagrams[3].time, at(kSecond, 600000000));
    EXPECT_EQ(reading.datagrams[1].payload, "bcd");
    EXPECT_EQ(reading.datagrams[2].payload, "efghi");
    // A simple packet block has no time, and a datagram without time is of no use.
    EXPECT_EQ(reading.counters.rejected.at("no_timestamp"), 1U);
  }
}

TEST(PcapFileSource, ReadsPcapngSectionsOfDifferentByteOrder) {
  ByteString file;
  for (const Endian endian : kEndians) {
    file += test::ng_section(endian) + test::ng_interface(endian, 1) +
            test::ng_enhanced(endian, 0, kSecond * 1'000'000ULL, ethernet(udp("x")));
  }
  EXPECT_EQ(read_bytes(file).datagrams.size(), 2U);
}

TEST(PcapFileSource, RejectsPcapngTimesThatNoTimestampHolds) {
  const auto little = Endian::kLittle;
  const ByteString file = test::ng_section(little) + test::ng_interface(little, 1) +
                          test::ng_enhanced(little, 0, ~0ULL, ethernet(udp("x")));
  EXPECT_EQ(read_bytes(file).counters.rejected.at("no_timestamp"), 1U);
}

TEST(PcapFileSource, ReadsEveryLinkLayer) {
  const ByteString packet = udp("csi");
  const std::vector<std::pair<std::uint32_t, ByteString>> layers = {
      {1, ethernet(packet)},
      {1, ethernet(packet) + ByteString(4, '\x5a')},  // frame check sequence or padding
      {1, test::vlan_ethernet(packet, 1)},
      {1, test::vlan_ethernet(packet, 2)},
      {0x54000001, ethernet(packet)},  // the upper bits: length of the frame check sequence
      {0, test::bsd_loopback(packet, Endian::kLittle)},
      {0, test::bsd_loopback(packet, Endian::kBig)},
      {108, test::bsd_loopback(packet, Endian::kBig)},
      {12, packet},
      {14, packet},
      {101, packet},
      {228, packet},
      {113, test::linux_cooked(packet)},
      {276, test::linux_cooked_v2(packet)},
      {1, ethernet(ipv4({.payload = "csi", .ip_options = ByteString(8, '\x01')}))}};
  for (const auto& [link_type, bytes] : layers) {
    const Reading reading = read_bytes(classic({bytes}, link_type));
    ASSERT_EQ(reading.datagrams.size(), 1U) << "link type " << link_type;
    EXPECT_EQ(reading.datagrams[0].payload, "csi") << "link type " << link_type;
  }
}

TEST(PcapFileSource, RejectsNonUdpPacketsWithAReason) {
  using Case = std::pair<std::string, ByteString>;
  const ByteString whole = ethernet(udp("payload"));
  const std::vector<Case> cases = {
      {"not_udp", ethernet(ipv4({.payload = "x", .protocol = 6}))},
      {"not_udp", ethernet(udp("arp"), 0x0806)},
      {"ipv6", ethernet(ByteString(1, 0x60) + ByteString(60, '\0'), 0x86dd)},
      {"ip_fragment", ethernet(ipv4({.payload = "x", .fragment = 0x2000}))},
      {"ip_fragment", ethernet(ipv4({.payload = "x", .fragment = 0x0007}))},
      {"bad_ip_header", ethernet(ByteString(1, 0x44) + udp("x").substr(1))},
      {"bad_ip_header", ethernet(ByteString(1, 0x55) + udp("x").substr(1))},
      {"length_mismatch", ethernet(ipv4({.payload = "x", .udp_length_error = 1}))},
      {"length_mismatch", ethernet(ipv4({.payload = "x", .udp_length_error = -2}))},
      {"length_mismatch", ethernet(ipv4({.payload = "x", .ip_length_error = 1}))},
      {"length_mismatch", ethernet(ipv4({.payload = "x", .ip_length_error = -2}))},
      {"length_mismatch", whole.substr(0, whole.size() - 1)},
      {"length_mismatch", whole.substr(0, 5)}};
  for (const auto& [reason, packet] : cases) {
    const Reading reading = read_bytes(classic({packet, ethernet(udp("good"))}));
    EXPECT_EQ(reading.error, "");
    EXPECT_EQ(reading.counters.rejected, (std::map<std::string, std::uint64_t>{{reason, 1}}));
    ASSERT_EQ(reading.datagrams.size(), 1U) << reason;
    EXPECT_EQ(reading.datagrams[0].payload, "good");
  }
  EXPECT_EQ(read_bytes(classic({udp("x")}, 189)).counters.rejected.at("link_type"), 1U);
  EXPECT_EQ(read_bytes(classic({udp("x")}, 229)).counters.rejected.at("ipv6"), 1U);
}

// As tcpdump -s 64 writes it.
TEST(PcapFileSource, RejectsPacketsTruncatedByTheSnapshotLength) {
  const ByteString packet = ethernet(udp(ByteString(500, 'x')));
  for (std::size_t captured = 0; captured < packet.size(); ++captured) {
    const Reading reading = read_bytes(pcap_header(Endian::kLittle, false) +
                                       pcap_record(Endian::kLittle,
                                                   kSecond,
                                                   0,
                                                   packet.substr(0, captured),
                                                   static_cast<std::uint32_t>(packet.size())));
    ASSERT_EQ(reading.counters.rejected.at("truncated_capture"), 1U) << captured;
  }
}

TEST(PcapFileSource, AcceptsEveryPortUnlessOneIsGiven) {
  const ByteString file = classic({ethernet(ipv4({.destination_port = 5500, .payload = "a"})),
                                   ethernet(ipv4({.destination_port = 5501, .payload = "b"}))});
  EXPECT_EQ(read_bytes(file).datagrams.size(), 2U);
  const Reading reading = read_bytes(file, {.port = 5501});
  ASSERT_EQ(reading.datagrams.size(), 1U);
  EXPECT_EQ(reading.datagrams[0].payload, "b");
  EXPECT_EQ(reading.counters.rejected.at("wrong_port"), 1U);
}

TEST(PcapFileSource, ReadsGzipOfSeveralMembersAndOfHighCompression) {
  // 6 MB of packets that pack to a few kB: the unpacked bytes do not fit a buffer at once.
  std::vector<ByteString> packets(4000);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    packets[i] = ethernet(udp(ByteString(i % 3000, 'z')));
  }
  const ByteString file = classic(packets);
  const std::size_t half = file.size() / 2 + 11;
  for (const ByteString& packed :
       {test::gzip(file), test::gzip(file.substr(0, half)) + test::gzip(file.substr(half))}) {
    const Reading reading = read_bytes(packed);
    EXPECT_EQ(reading.error, "");
    EXPECT_EQ(reading.warning, "");
    ASSERT_EQ(reading.datagrams.size(), packets.size());
    EXPECT_EQ(reading.datagrams[2999].payload, ByteString(2999, 'z'));
  }
}

// A recording may be cut off at any length: the records before the cut are delivered, the torn one
// is counted, and only a file without any record is an error.
TEST(PcapFileSource, ReadsEveryTruncationOfAFile) {
  const std::vector<ByteString> packets = {
      ethernet(udp("first")), ethernet(udp("second")), ethernet(udp("third"))};
  const auto little = Endian::kLittle;
  ByteString ng = test::ng_section(little) + test::ng_interface(little, 1);
  for (const ByteString& packet : packets) {
    ng += test::ng_enhanced(little, 0, kSecond * 1'000'000ULL, packet);
  }
  for (const ByteString& file : {classic(packets), ng}) {
    std::size_t most = 0;
    for (std::size_t size = 0; size <= file.size(); ++size) {
      const Reading reading = read_bytes(file.substr(0, size));
      ASSERT_GE(reading.datagrams.size(), most);
      most = reading.datagrams.size();
      const bool torn = reading.counters.rejected.contains("torn_record");
      ASSERT_EQ(torn, !reading.warning.empty());
      ASSERT_TRUE(most == 0 || reading.error.empty()) << reading.error;
      if (torn) {
        ASSERT_THAT(reading.warning, HasSubstr(": byte "));
      }
      ASSERT_EQ(reading.watermark == Timestamp::max(), reading.error.empty());
    }
    EXPECT_EQ(most, packets.size());
  }
}

TEST(PcapFileSource, ReadsEveryTruncationOfAGzipFile) {
  const ByteString packed = test::gzip(classic({ethernet(udp("a")), ethernet(udp("b"))}));
  for (std::size_t size = 0; size < packed.size(); ++size) {
    const Reading reading = read_bytes(packed.substr(0, size));
    ASSERT_TRUE(!reading.error.empty() || !reading.warning.empty()) << size;
  }
  EXPECT_EQ(read_bytes(packed).warning, "");
}

TEST(PcapFileSource, NamesTheFileAndTheByteWhereItIsDamaged) {
  EXPECT_THAT(read_bytes("this is no capture").error, HasSubstr(": byte 0: not a pcap"));
  EXPECT_THAT(read_bytes("").error, HasSubstr(": byte 0: the file is empty"));
  const ByteString good = classic({ethernet(udp("good"))});
  const ByteString insane = test::u32(kSecond, Endian::kLittle) + ByteString(4, '\0') +
                            test::u32(0x7fffffff, Endian::kLittle) + ByteString(100, '\0');
  const Reading reading = read_bytes(good + insane);
  EXPECT_THAT(reading.error, HasSubstr(": byte " + std::to_string(good.size()) + ": "));
  EXPECT_THAT(reading.error, HasSubstr("pcap_source_test"));
  EXPECT_EQ(reading.datagrams.size(), 1U) << "what came before the damage is delivered";

  ByteString packed = test::gzip(classic(std::vector<ByteString>(50, ethernet(udp("x")))));
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 0x55);
  const Reading damaged = read_bytes(packed);
  EXPECT_THAT(damaged.error, HasSubstr("of the gzip'd file"));
  EXPECT_EQ(damaged.datagrams.size(), 50U);

  EXPECT_THAT(read_all("/nowhere/x.pcap").error, HasSubstr("/nowhere/x.pcap"));
  EXPECT_THAT(read_all("/tmp").error, HasSubstr("/tmp"));
}

TEST(PcapFileSource, ToleratesDisorderUpToTheStatedAmount) {
  ByteString file = pcap_header(Endian::kLittle, false);
  for (const std::uint32_t microseconds : {500000U, 450000U, 400000U, 399999U, 600000U}) {
    file += pcap_record(Endian::kLittle, kSecond, microseconds, ethernet(udp("x")));
  }
  const Reading reading = read_bytes(file);
  EXPECT_EQ(reading.datagrams.size(), 4U);
  EXPECT_EQ(reading.counters.rejected.at("time_went_back"), 1U);
  EXPECT_EQ(read_bytes(file, {.port = {}, .max_disorder = kAnyDisorder}).datagrams.size(), 5U);
  EXPECT_EQ(read_bytes(file, {.port = {}, .max_disorder = Duration(0)}).datagrams.size(), 2U);
}

// ssh ap tcpdump -w - | rayloc ...: packets must not wait for more or for the end.
TEST(PcapFileSource, DeliversFromAPipeAsPacketsArrive) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  auto source = PcapFileSource::open("/dev/fd/" + std::to_string(ends[0]));
  ASSERT_TRUE(source) << source.error().message;
  const auto put = [&ends](const ByteString& bytes) {
    ASSERT_EQ(write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  };
  DatagramBatch batch;
  const auto read = [&] {
    const auto done = (*source)->read(batch, std::chrono::milliseconds(1));
    ASSERT_TRUE(done) << done.error().message;
  };
  const ByteString file = classic({ethernet(udp("first")), ethernet(udp("second"))});
  const std::size_t cut = file.size() - 10;
  read();
  EXPECT_TRUE(batch.datagrams.empty());
  EXPECT_FALSE(batch.ended);
  put(file.substr(0, 10));
  read();
  EXPECT_TRUE(batch.datagrams.empty());
  put(file.substr(10, cut - 10));
  read();
  ASSERT_EQ(batch.datagrams.size(), 1U);
  EXPECT_FALSE(batch.ended);
  EXPECT_EQ(batch.watermark, at(kSecond, 0) - PcapFileOptions().max_disorder);
  put(file.substr(cut));
  read();
  EXPECT_EQ(batch.datagrams.size(), 1U);
  close(ends[1]);
  read();
  EXPECT_TRUE(batch.ended);
  EXPECT_EQ((*source)->counters().delivered, 2U);
  close(ends[0]);
}

}  // namespace
}  // namespace rayloc::pcap_source_test
