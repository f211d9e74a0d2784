// Recordings with padding behind their end, as tapes, flash and transfers in blocks leave it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "capture/source/recorded_source.h"
#include "tests/support/pcap_files.h"

namespace rayloc::field_padding_test {
namespace {

using test::ByteString;
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

struct Given {
  std::size_t datagrams = 0;
  std::map<std::string, std::uint64_t> rejected;
  std::vector<std::string> words;
  std::string error;
};

Given read_path(const std::string& path) {
  Given given;
  auto source = RecordedSource::open({path});
  DatagramBatch batch;
  while (source && !batch.ended && given.error.empty()) {
    const auto read = (*source)->read(batch, std::chrono::seconds(1));
    given.error = read ? "" : read.error().message;
    given.datagrams += batch.datagrams.size();
  }
  given.rejected = (*source)->counters().rejected;
  given.words = words_of((*source)->plan());
  const auto warnings = (*source)->warnings();
  given.words.insert(given.words.end(), warnings.begin(), warnings.end());
  return given;
}

std::vector<Given> read_both(const ByteString& bytes) {
  const std::string path = test::temporary_path("field_padding.pcap");
  test::write_file(path, bytes);
  std::vector<Given> both = {read_path(path)};
  // Byte by byte at the end: what a pipe brings must not depend on how it comes.
  const std::string command = "head -c -7 " + path + "; for i in 7 6 5 4 3 2 1; do tail -c $i " +
                              path + " | head -c 1; done";
  std::FILE* const pipe = popen(command.c_str(), "r");
  both.push_back(read_path("/dev/fd/" + std::to_string(fileno(pipe))));
  pclose(pipe);
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
    for (const Given& given : read_both(packed + padding)) {
      EXPECT_EQ(given.error, "");
      EXPECT_EQ(given.datagrams, 10U);
      EXPECT_THAT(given.rejected, IsEmpty());
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
    for (const Given& given : read_both(file)) {
      EXPECT_EQ(given.error, "");
      EXPECT_EQ(given.datagrams, 20U);
      EXPECT_THAT(given.rejected, IsEmpty());
    }
  }
}

TEST(Field, ZerosBehindAPlainCaptureAreLeftOutAndNotedOnce) {
  for (const ByteString& whole : {capture(), pcapng()}) {
    for (const std::size_t zeros : {16U, 100U, 4096U}) {
      for (const Given& given : read_both(whole + ByteString(zeros, '\0'))) {
        EXPECT_EQ(given.error, "");
        EXPECT_EQ(given.datagrams, 10U);
        EXPECT_THAT(given.rejected, IsEmpty());
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
