// Recordings with padding behind their end, as tapes, flash and transfers in blocks leave it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/pcap_files.h"
#include "tests/support/recording_answer.h"

namespace rayloc::field_padding_test {
namespace {

using test::ByteString;
using test::RecordingAnswer;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr auto kLittle = test::Endian::kLittle;
constexpr std::uint32_t kStart = 1'718'001'352;  // [s]

ByteString capture(std::uint32_t start = kStart) {
  ByteString file = test::pcap_header(kLittle, false);
  for (std::uint32_t i = 0; i < 10; ++i) {
    file += test::pcap_record(
        kLittle, start, 100'000 * i, test::ethernet(test::ipv4({.payload = "csi"})));
  }
  return file;
}

ByteString pcapng() {
  ByteString file = test::ng_section(kLittle) + test::ng_interface(kLittle, 1);
  for (std::uint32_t i = 0; i < 10; ++i) {
    file += test::ng_enhanced(kLittle,
                              0,
                              kStart * std::uint64_t{1'000'000} + std::uint64_t{100'000} * i,
                              test::ethernet(test::ipv4({.payload = "csi"})));
  }
  return file;
}

// The last seven bytes come one by one in the pipe: the answer must not depend on how it splits
// them.
std::vector<RecordingAnswer> read_both(const ByteString& bytes) {
  const std::string path = test::temporary_path("field_padding.pcap");
  test::write_file(path, bytes);
  std::vector<RecordingAnswer> both = {
      test::answer_of(path),
      test::read_command("head -c -7 " + path + "; for i in 7 6 5 4 3 2 1; do tail -c $i " + path +
                         " | head -c 1; done")};
  std::filesystem::remove(path);
  return both;
}

TEST(Field, PaddingBehindGzipIsLeftOutAndNotedOnce) {
  const ByteString packed = test::gzip(capture());
  for (const ByteString& padding : {ByteString(1, '\0'),
                                    ByteString(512, '\0'),
                                    ByteString(3 << 16, '\0'),
                                    ByteString("\x1f"),
                                    ByteString("\x1f\x8b"),
                                    ByteString("\n"),
                                    ByteString("\0\0garbage", 9),
                                    ByteString(3 << 16, '\x5a')}) {
    for (const RecordingAnswer& given : read_both(packed + padding)) {
      EXPECT_EQ(given.error, "");
      EXPECT_EQ(given.times.size(), 10U);
      EXPECT_THAT(given.counters.rejected, IsEmpty());
      EXPECT_THAT(given.words,
                  ElementsAre(AllOf(HasSubstr("byte " + std::to_string(packed.size()) + " of"),
                                    HasSubstr(std::to_string(padding.size()) + " bytes"),
                                    HasSubstr("padding"))));
    }
  }
}

TEST(Field, MembersAndCapturesBehindPaddingAreRead) {
  const ByteString packed = test::gzip(capture());
  const ByteString zeros(300, '\0');
  for (const ByteString& file : {packed + zeros + test::gzip(capture(kStart + 1)),
                                 packed + capture(kStart + 1),
                                 packed + zeros + capture(kStart + 1)}) {
    for (const RecordingAnswer& given : read_both(file)) {
      EXPECT_EQ(given.error, "");
      EXPECT_EQ(given.times.size(), 20U);
      EXPECT_THAT(given.counters.rejected, IsEmpty());
    }
  }
}

TEST(Field, ZerosBehindAPlainCaptureAreLeftOutAndNotedOnce) {
  for (const ByteString& whole : {capture(), pcapng()}) {
    for (const std::size_t zeros : {16U, 100U, 4096U}) {
      for (const RecordingAnswer& given : read_both(whole + ByteString(zeros, '\0'))) {
        EXPECT_EQ(given.error, "");
        EXPECT_EQ(given.times.size(), 10U);
        EXPECT_THAT(given.counters.rejected, IsEmpty());
        EXPECT_THAT(given.words,
                    ElementsAre(AllOf(HasSubstr("byte " + std::to_string(whole.size()) + ":"),
                                      HasSubstr(std::to_string(zeros) + " zero bytes"))));
      }
    }
  }
}

TEST(Field, ADamagedMemberIsStillDamage) {
  ByteString packed = test::gzip(capture());
  packed[packed.size() - 6] = static_cast<char>(packed[packed.size() - 6] ^ 0x55);
  EXPECT_THAT(read_both(packed).front().error, HasSubstr("gzip'd file"));
}

}  // namespace
}  // namespace rayloc::field_padding_test
