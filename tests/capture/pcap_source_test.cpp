// Every kind of capture file that PcapFileSource must read, written byte by byte by
// tests/support/pcap_files.h.
#include "capture/pcap_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <numeric>

#include "tests/support/pcap_files.h"

namespace rayloc {
namespace {

using test::ByteString;
using test::Endian;
using test::ethernet;
using test::ipv4;
using test::pcap_header;
using test::pcap_record;
using ::testing::HasSubstr;

constexpr std::array kEndians = {Endian::kLittle, Endian::kBig};
constexpr std::uint32_t kSecond = 1525500671;  // that of the golden datagram of AXCSI.md 1.1

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
  reading.warning = (*source)->warning();
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

}  // namespace
}  // namespace rayloc
