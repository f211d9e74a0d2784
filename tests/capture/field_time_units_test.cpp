// Recordings whose headers state another unit of time than their stamps have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/support/pcap_files.h"
#include "tests/support/recording_answer.h"

namespace rayloc::field_time_units_test {
namespace {

using test::ByteString;
using test::Endian;
using test::read_as_file;
using test::read_as_pipe;
using test::RecordingAnswer;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Stamps = std::vector<std::int64_t>;  // [ns]

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStart = 1'718'001'352 * kSecond + 459'123'000;

// Frames of three datagrams each 100 ms.
Stamps walk(int frames, std::int64_t from = kStart, std::int64_t period = kSecond / 10) {
  Stamps stamps;
  for (int i = 0; i < 3 * frames; ++i) {
    stamps.push_back(from + i / 3 * period + std::int64_t{10'000} * (i % 3));
  }
  return stamps;
}

enum class Unit { kMicro, kNano };

ByteString packet() { return test::ethernet(test::ipv4({.payload = "csi"})); }

ByteString classic(const Stamps& stamps, Unit stated, Unit written, Endian endian) {
  ByteString file = test::pcap_header(endian, stated == Unit::kNano);
  for (const std::int64_t stamp : stamps) {
    const std::int64_t fraction = stamp % kSecond;
    file += test::pcap_record(
        endian,
        static_cast<std::uint32_t>(stamp / kSecond),
        static_cast<std::uint32_t>(written == Unit::kNano ? fraction : fraction / 1000),
        packet());
  }
  return file;
}

// `resolution`: if_tsresol; none is microseconds.
ByteString pcapng(const Stamps& stamps, std::optional<char> resolution, Unit written) {
  const auto little = Endian::kLittle;
  const ByteString options =
      resolution ? test::ng_option(little, 9, ByteString(1, *resolution)) : ByteString();
  ByteString file = test::ng_section(little) + test::ng_interface(little, 1, options);
  for (const std::int64_t stamp : stamps) {
    file +=
        test::ng_enhanced(little,
                          0,
                          static_cast<std::uint64_t>(written == Unit::kNano ? stamp : stamp / 1000),
                          packet());
  }
  return file;
}

Stamps stamps_of(const RecordingAnswer& answer) {
  Stamps stamps;
  for (const Timestamp time : answer.times) {
    stamps.push_back(time.time_since_epoch().count());
  }
  return stamps;
}

TEST(Field, NanosecondsInAFileOfMicrosecondsAreReadAsSuch) {
  for (const Endian endian : {Endian::kLittle, Endian::kBig}) {
    const Stamps stamps = walk(40);
    const ByteString file = classic(stamps, Unit::kMicro, Unit::kNano, endian);
    for (const RecordingAnswer& given : test::read_both(file)) {
      EXPECT_EQ(stamps_of(given), stamps);
      EXPECT_THAT(given.counters.rejected, IsEmpty());
      EXPECT_THAT(given.words,
                  ElementsAre(AllOf(HasSubstr("byte 0: "),
                                    HasSubstr("states microseconds"),
                                    HasSubstr("read as nanoseconds"))));
    }
  }
}

// A value below 1,000,000 may come first: the look through the file has the unit by then.
TEST(Field, ANanosecondValueThatCouldBeMicrosecondsIsReadAsTheOthers) {
  const Stamps stamps = walk(40, 1'718'001'352 * kSecond + 400'000);
  EXPECT_EQ(stamps_of(read_as_file(classic(stamps, Unit::kMicro, Unit::kNano, Endian::kLittle))),
            stamps);
}

TEST(Field, MicrosecondsInAFileOfNanosecondsAreReadAsSuch) {
  for (const std::int64_t period : {kSecond / 100, kSecond / 10, kSecond * 31 / 100}) {
    const Stamps stamps = walk(120, kStart, period);
    const ByteString file = classic(stamps, Unit::kNano, Unit::kMicro, Endian::kLittle);
    const RecordingAnswer given = read_as_file(file);
    EXPECT_EQ(stamps_of(given), stamps) << period;
    EXPECT_THAT(
        given.words,
        ElementsAre(AllOf(HasSubstr("states nanoseconds"), HasSubstr("read as microseconds"))));
    const RecordingAnswer piped = read_as_pipe(file);
    ASSERT_FALSE(piped.words.empty());
    EXPECT_THAT(piped.words[0], AllOf(HasSubstr("hold microseconds"), HasSubstr("to a file")));
  }
}

TEST(Field, TheStatedUnitHoldsWhereNoValueContradictsIt) {
  const std::vector<Stamps> recordings = {
      {kStart},
      walk(1),
      walk(40),
      walk(3, 1'718'001'352 * kSecond, 20'000),               // one burst within a millisecond
      walk(20, 1'718'001'352 * kSecond + 150'000, kSecond),   // a sender that is synchronised
      walk(7, 1'718'001'352 * kSecond + 999'950'000, 20'000)  // a burst across a second
  };
  for (const Stamps& stamps : recordings) {
    for (const Unit unit : {Unit::kMicro, Unit::kNano}) {
      const ByteString file = classic(stamps, unit, unit, Endian::kLittle);
      for (const RecordingAnswer& given : test::read_both(file)) {
        EXPECT_EQ(stamps_of(given), stamps);
        EXPECT_THAT(given.words, IsEmpty());
      }
    }
  }
}

// One value that cannot be microseconds is damaged, wherever it lies.
TEST(Field, ADamagedSubsecondValueDoesNotChangeTheUnit) {
  for (const std::size_t where : {0U, 1U, 60U}) {
    ByteString file = classic(walk(40), Unit::kMicro, Unit::kMicro, Endian::kLittle);
    const std::size_t record = 16 + packet().size();
    file[24 + where * record + 7] = '\x35';  // 889 to 905 s of microseconds
    const RecordingAnswer given = read_as_file(file);
    EXPECT_EQ(given.times.size(), 119U) << where;
    for (const std::string& line : given.words) {
      EXPECT_THAT(line, HasSubstr("damaged_time"));
    }
  }
}

TEST(Field, AWrongResolutionOfAPcapngInterfaceIsNamedAndUndone) {
  const Stamps stamps = walk(40);
  const std::vector<std::tuple<std::optional<char>, Unit, std::string>> cases = {
      {std::nullopt, Unit::kNano, "10^-6 s"},
      {'\x06', Unit::kNano, "10^-6 s"},
      {'\x09', Unit::kMicro, "10^-9 s"},
      {'\x03', Unit::kMicro, "10^-3 s"},
      {'\x94', Unit::kNano, "2^-20 s"}};
  for (const auto& [resolution, written, text] : cases) {
    const ByteString file = pcapng(stamps, resolution, written);
    for (const RecordingAnswer& given : test::read_both(file)) {
      EXPECT_EQ(stamps_of(given), stamps);
      EXPECT_THAT(
          given.words,
          ElementsAre(AllOf(HasSubstr("interface 0"), HasSubstr(text), HasSubstr("if_tsresol"))));
    }
  }
  EXPECT_THAT(read_as_file(pcapng(stamps, '\x09', Unit::kNano)).words, IsEmpty());
  EXPECT_THAT(read_as_file(pcapng(stamps, std::nullopt, Unit::kMicro)).words, IsEmpty());
}

}  // namespace
}  // namespace rayloc::field_time_units_test
