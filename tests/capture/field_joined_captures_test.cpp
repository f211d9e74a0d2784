// Captures that were joined by `cat`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/pcap_files.h"
#include "tests/support/recording_answer.h"

namespace rayloc::field_joined_captures_test {
namespace {

using test::ByteString;
using test::Endian;
using test::ethernet;
using test::ipv4;
using test::read_both;
using test::RecordingAnswer;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint32_t kStart = 1'718'001'352;  // [s]

struct Capture {
  bool pcapng = false;
  Endian endian = Endian::kLittle;
  bool nanoseconds = false;
  std::uint32_t link_type = 1;
  std::uint32_t start = kStart;
};

// Ten datagrams in a second.
ByteString bytes_of(const Capture& capture, const std::string& payload) {
  const ByteString ip = ipv4({.payload = payload});
  const ByteString packet = capture.link_type == 1 ? ethernet(ip) : ip;
  const auto endian = capture.endian;
  const std::uint32_t per_second = capture.nanoseconds ? 1'000'000'000 : 1'000'000;
  ByteString file = test::pcap_header(endian, capture.nanoseconds, capture.link_type);
  if (capture.pcapng) {
    const auto option = test::ng_option(endian, 9, ByteString(1, '\x09'));
    file =
        test::ng_section(endian) + test::ng_interface(endian,
                                                      static_cast<std::uint16_t>(capture.link_type),
                                                      capture.nanoseconds ? option : ByteString());
  }
  for (std::uint32_t i = 0; i < 10; ++i) {
    const std::uint32_t fraction = per_second / 1000 * (100 * i + 7);
    file += capture.pcapng
                ? test::ng_enhanced(
                      endian, 0, std::uint64_t{capture.start} * per_second + fraction, packet)
                : test::pcap_record(endian, capture.start, fraction, packet);
  }
  return file;
}

std::vector<Timestamp> even_times(int seconds) {
  std::vector<Timestamp> times;
  times.reserve(std::size_t{10} * static_cast<std::size_t>(seconds));
  for (int i = 0; i < 10 * seconds; ++i) {
    times.push_back(Timestamp(std::chrono::seconds(kStart)) +
                    std::chrono::milliseconds(100 * i + 7));
  }
  return times;
}

TEST(Field, ACaptureBehindAnotherOneIsReadAsWell) {
  const std::vector<Capture> kinds = {
      {},
      {.endian = Endian::kBig},
      {.nanoseconds = true},
      {.link_type = 101},
      {.pcapng = true},
      {.pcapng = true, .endian = Endian::kBig, .nanoseconds = true, .link_type = 101}};
  for (Capture first : kinds) {
    for (Capture second : kinds) {
      second.start = kStart + 1;
      const ByteString a = bytes_of(first, "first");
      const ByteString b = bytes_of(second, "second");
      const ByteString plain = a + b;
      for (const ByteString& file : {plain, test::gzip(plain), test::gzip(a) + test::gzip(b)}) {
        for (const RecordingAnswer& given : read_both(file)) {
          EXPECT_EQ(given.error, "");
          EXPECT_EQ(given.times, even_times(2));
          EXPECT_THAT(given.counters.rejected, IsEmpty());
          EXPECT_THAT(given.words,
                      ElementsAre(AllOf(HasSubstr("byte " + std::to_string(a.size()) + ": "),
                                        HasSubstr("another capture begins"))));
        }
      }
    }
  }
}

TEST(Field, ManyJoinedCapturesAreNotedOnce) {
  ByteString file;
  for (std::uint32_t i = 0; i < 5; ++i) {
    file += bytes_of({.start = kStart + i}, "x");
  }
  const RecordingAnswer given = read_both(file).front();
  EXPECT_EQ(given.times, even_times(5));
  EXPECT_THAT(given.words, ElementsAre(HasSubstr("3 more")));
}

// Joined in another order than that of time: no clock was set.
TEST(Field, AnEarlierCaptureBehindALaterOneIsNoClockStep) {
  const ByteString later = bytes_of({.start = kStart + 100}, "b");
  const RecordingAnswer given = read_both(later + bytes_of({}, "a")).front();
  EXPECT_EQ(given.times.size(), 20U);
  EXPECT_THAT(given.words,
              Contains(AllOf(HasSubstr("begins at byte " + std::to_string(later.size())),
                             HasSubstr("split the file"))));
  for (const std::string& line : given.words) {
    EXPECT_THAT(line, ::testing::Not(HasSubstr("clock was set")));
  }
}

// 2055-12-18, when the seconds have the value of the magic number.
TEST(Field, ARecordWithTheSecondsOfAMagicNumberIsARecord) {
  const ByteString file = bytes_of({.start = 0xa1b2c3d4}, "x");
  for (const RecordingAnswer& given : read_both(file)) {
    EXPECT_EQ(given.times.size(), 10U);
    EXPECT_THAT(given.words, IsEmpty());
  }
}

}  // namespace
}  // namespace rayloc::field_joined_captures_test
