#include "daemon/cli/capture_argument.h"

#include <gtest/gtest.h>

namespace rayloc::cli {
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

TEST(CaptureArgument, RefusesWhatIsUnclear) {
  const std::vector<std::string> ids = {"ap1", "ap2"};
  EXPECT_NE(resolve_captures({"x.pcap"}, ids).error().message.find("ap1, ap2"), std::string::npos);
  EXPECT_NE(resolve_captures({"ap3=x.pcap"}, ids).error().message.find("'ap3'"), std::string::npos);
  EXPECT_NE(resolve_captures({"ap1=x", "ap1=y"}, ids).error().message.find("already"),
            std::string::npos);
}

}  // namespace
}  // namespace rayloc::cli
