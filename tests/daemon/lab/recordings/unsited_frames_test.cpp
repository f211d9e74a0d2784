#include "daemon/lab/recordings/unsited_frames.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/pcap_files.h"
#include "tests/support/wire_writer.h"

namespace rayloc::unsited_frames_test {
namespace {

// A recording of one frame by four cores.
class UnsitedFrames : public ::testing::Test {
 protected:
  void SetUp() override {
    test::ByteString bytes = test::pcap_header(test::Endian::kLittle, false);
    for (const auto& datagram : test::write_axcsi({}, {})) {
      test::UdpPacket packet;
      packet.payload.assign(reinterpret_cast<const char*>(datagram.payload.data()),
                            datagram.payload.size());
      bytes += test::pcap_record(
          test::Endian::kLittle, 1'525'500'671, 306'626, test::ethernet(test::ipv4(packet)));
    }
    std::ofstream(file_, std::ios::binary) << bytes;
  }
  void TearDown() override { std::filesystem::remove(file_); }

  Expected<void> read(const std::string& format, const Expected<void>& taken) {
    CsiReceiverOptions options;
    options.format = format;
    return read_unsited_frames(
        {"", {file_}},
        options,
        [&](std::vector<CsiFrame>& frames) {
          count_ += frames.size();
          return taken;
        },
        summary_,
        notes_);
  }

  std::string file_ = ::testing::TempDir() + "unsited_" + std::to_string(::getpid()) + ".pcap";
  std::size_t count_ = 0;
  FrameSummary summary_;
  std::vector<std::string> notes_;
};

TEST_F(UnsitedFrames, AreReadWithTheirOutcome) {
  const auto read_all = read("", {});
  ASSERT_TRUE(read_all) << read_all.error().message;
  EXPECT_EQ(count_, 1U);
  EXPECT_EQ(summary_.datagrams, 4U);
  EXPECT_EQ(summary_.decoded, 4U);
  EXPECT_TRUE(check_summary(summary_));
  EXPECT_EQ(recording_name({"", {file_}}), file_);
  EXPECT_EQ(recording_name({"ap1", {file_}}), "ap1");
}

TEST_F(UnsitedFrames, EndAtAnErrorOfTheirReader) {
  const auto ended = read("", make_error(ErrorKind::kUnavailable, "full"));
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().message, "full");
  EXPECT_EQ(summary_.datagrams, 0U);
}

TEST_F(UnsitedFrames, WithoutCsiAreAnError) {
  ASSERT_TRUE(read("ubilocate", {}));
  EXPECT_EQ(summary_.rejected["length_mismatch"], 4U);
  const auto none = check_summary(summary_);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kBadInput);
}

TEST(WireFormat, IsOneOfTheKnown) {
  EXPECT_TRUE(check_wire_format(""));
  EXPECT_TRUE(check_wire_format("axcsi-v4"));
  const auto unknown = check_wire_format("axcsi");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().kind, ErrorKind::kUsage);
  EXPECT_NE(unknown.error().message.find("axcsi-v4, intel-5300"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::unsited_frames_test
