// Tests a replay without a terminal: its summary and notices, and requests that are refused.
#include "daemon/lab/replay/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::replay::lab_replay_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

const std::string kSite = test::data_path("/sites/meeting_room");
const std::string kRecording = kSite + "/device_los-ap1.pcap.gz";

Expected<Prepared> prepared(const std::string& capture, const Options& options = {}) {
  const auto site = load_site(kSite);
  RAYLOC_TRY(site);
  Recordings recordings;
  recordings.captures = {capture};
  return prepare(*site, options, recordings, {}, {});
}

// The site has no calibration: there are snapshots, and none has a position.
TEST(LabReplay, ReturnsTheSummaryOfItsRecordings) {
  Options options;
  options.burst = std::chrono::seconds(2);
  auto replay = prepared("ap1=" + kRecording, options);
  ASSERT_TRUE(replay) << replay.error().message;
  std::size_t locations = 0;
  Output output;
  output.on_location = [&](const Location& /*location*/) { ++locations; };
  const Summary summary = run(*replay, {}, output);
  EXPECT_GT(locations, 0U);
  EXPECT_GT(summary.counters.snapshots, 0U);
  EXPECT_EQ(summary.counters.no_fix, summary.counters.snapshots);
  ASSERT_EQ(summary.sources.size(), 1U);
  EXPECT_EQ(summary.sources.front().access_point, "ap1");
  EXPECT_GT(summary.sources.front().frames, 0U);
  EXPECT_EQ(summary.sources.front().error, "");
  EXPECT_EQ(summary.no_frames, "");
  EXPECT_THAT(take_notices(*replay).lacks,
              Contains(HasSubstr("nothing can be located: the access points in use are not "
                                 "calibrated (ap1)")));
}

TEST(LabReplay, NeedsToKnowWhichAccessPointRecorded) {
  const auto replay = prepared(kRecording);
  ASSERT_FALSE(replay);
  EXPECT_EQ(replay.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(replay.error().message, HasSubstr("ap1, ap2, ap3"));
}

TEST(LabReplay, NamesTheFileThatCannotBeRead) {
  const auto missing = prepared("ap1=missing.pcap");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kUnavailable);
  auto foreign = prepared("ap1=" + kSite + "/site.toml");
  ASSERT_TRUE(foreign) << foreign.error().message;
  const Summary summary = run(*foreign, {}, {});
  ASSERT_EQ(summary.sources.size(), 1U);
  EXPECT_THAT(summary.sources.front().error, HasSubstr("site.toml"));
}

TEST(LabReplay, RefusesAKindThatTheMethodCannotLocate) {
  for (const Method* method : methods()) {
    EXPECT_EQ(check_kind(*method, Kind::kDevice).has_value(), method->create_device != nullptr)
        << method->name;
    EXPECT_EQ(check_kind(*method, Kind::kPerson).has_value(), method->create_person != nullptr)
        << method->name;
  }
}

}  // namespace
}  // namespace rayloc::replay::lab_replay_test
