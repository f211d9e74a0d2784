#include "daemon/lab/recordings/capture_argument.h"

#include <gtest/gtest.h>

namespace rayloc::capture_argument_test {
namespace {

TEST(CaptureArgument, SplitsAtTheAccessPoint) {
  EXPECT_EQ(parse_capture_argument("ap1=x.pcap").access_point, "ap1");
  EXPECT_EQ(parse_capture_argument("ap1=x.pcap").file, "x.pcap");
  EXPECT_EQ(parse_capture_argument("-").file, "-");
  EXPECT_EQ(parse_capture_argument("dir/a=b.pcap").access_point, "");
  EXPECT_EQ(parse_capture_argument("dir/a=b.pcap").file, "dir/a=b.pcap");
}

TEST(CaptureArgument, NeedsNoNameWithOneAccessPoint) {
  const auto captures = resolve_captures({"x.pcap"}, {"ap1"});
  ASSERT_TRUE(captures.has_value());
  EXPECT_EQ(captures->at(0).access_point, "ap1");
}

TEST(CaptureArgument, TakesSeveralFilesOfAnAccessPointWhereAskedTo) {
  const auto captures =
      resolve_captures({"ap1=x", "ap1=y"}, {"ap1", "ap2"}, PerAccessPoint::kSeveral);
  ASSERT_TRUE(captures.has_value());
  EXPECT_EQ(captures->at(1).file, "y");
}

TEST(Field, FilesOfOneAccessPointAreOneRecording) {
  const auto captures =
      resolve_captures({"ap1=b", "ap2=x", "ap1=a"}, {"ap1", "ap2"}, PerAccessPoint::kSeveral);
  ASSERT_TRUE(captures.has_value());
  const auto recordings = recordings_of(*captures);
  ASSERT_EQ(recordings.size(), 2U);
  EXPECT_EQ(recordings[0].access_point, "ap1");
  EXPECT_EQ(recordings[0].files, (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(files_text(recordings[0]), "b, a");
  // Without a list of access points, each file without a name is a separate recording.
  EXPECT_EQ(recordings_of_any({"x", "ap1=a", "y", "ap1=b"}).size(), 3U);
}

TEST(CaptureArgument, RefusesAmbiguousArguments) {
  const std::vector<std::string> ids = {"ap1", "ap2"};
  EXPECT_NE(resolve_captures({"x.pcap"}, ids).error().message.find("ap1, ap2"), std::string::npos);
  EXPECT_NE(resolve_captures({"ap3=x.pcap"}, ids).error().message.find("'ap3'"), std::string::npos);
  EXPECT_NE(resolve_captures({"ap1=x", "ap1=y"}, ids).error().message.find("already"),
            std::string::npos);
}

}  // namespace
}  // namespace rayloc::capture_argument_test
