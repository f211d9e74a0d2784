// The mark of a gap is a datagram that our reader counts and does not deliver.
#include "capture/record/recording_gap.h"

#include <gtest/gtest.h>

#include "capture/record/pcap_format.h"
#include "capture/source/pcap_source.h"
#include "tests/support/pcap_files.h"
#include "tests/support/read_to_end.h"

namespace rayloc::recording_gap_test {
namespace {

Timestamp at(std::int64_t microseconds) {
  return Timestamp(std::chrono::microseconds(microseconds));
}

const RecordingGap kGap{120, "no_room", at(1'763'816'400'123'456), at(1'763'816'401'000'007)};

TEST(RecordingGap, ReadsBackItsLineOfText) {
  const std::string text = gap_text(kGap);
  EXPECT_EQ(text,
            "rayloc-gap datagrams=120 reason=no_room from=1763816400.123456 to=1763816401.000007");
  EXPECT_EQ(recording_gap(gap_mark(text, at(1))), kGap);
  RecordingGap unknown = kGap;
  unknown.datagrams.reset();
  const std::string unknown_text = gap_text(unknown);
  EXPECT_EQ(recording_gap(gap_mark(unknown_text, at(1))), unknown);
}

TEST(RecordingGap, RejectsEverythingButAValidGapMark) {
  const std::string good = gap_text(kGap);
  for (const std::string& text : {std::string(),
                                  std::string("rayloc-gap"),
                                  std::string("rayloc-gap datagrams=1 reason=x"),
                                  std::string("rayloc-gap datagrams=-1 reason=x from=1.000000 "
                                              "to=2.000000"),
                                  std::string("rayloc-gap datagrams=1 reason=x from=1.5 to=2.5"),
                                  std::string("rayloc-gap datagrams=1 reason=x "
                                              "from=99999999999999.000000 to=2.000000"),
                                  "x" + good}) {
    EXPECT_FALSE(recording_gap(gap_mark(text, at(1)))) << text;
  }
  Datagram other_port = gap_mark(good, at(1));
  other_port.address.destination_port = 5500;
  EXPECT_FALSE(recording_gap(other_port));
  Datagram other_source = gap_mark(good, at(1));
  other_source.address.source_ip = 0x0a0a0a0a;
  EXPECT_FALSE(recording_gap(other_source)) << "nobody else can put one into a recording";
}

TEST(RecordingGap, TheReaderCountsItAndGivesTheRest) {
  const std::string payload = "csi";
  const std::string text = gap_text(kGap);
  std::vector<std::byte> file = pcap_file_header();
  for (const Datagram& datagram :
       {Datagram{at(1'000'000), {}, std::as_bytes(std::span(payload))},
        gap_mark(text, at(1'000'001)),
        Datagram{at(1'000'002), {}, std::as_bytes(std::span(payload))}}) {
    ASSERT_TRUE(append_pcap_record(datagram, file));
  }
  const std::string path = test::temporary_path("gap.pcap");
  test::write_file(path, test::ByteString(reinterpret_cast<const char*>(file.data()), file.size()));
  const auto source = PcapFileSource::open(path).value();
  std::size_t given = 0;
  test::read_to_end(*source, [&](const Datagram&) { ++given; });
  EXPECT_EQ(given, 2U);
  const SourceCounters counters = source->counters();
  EXPECT_EQ(counters.received, 3U);
  EXPECT_EQ(counters.rejected, (std::map<std::string, std::uint64_t>{{"gap_mark", 1}}));
  EXPECT_EQ(counters.unrecorded, 120U);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace rayloc::recording_gap_test
