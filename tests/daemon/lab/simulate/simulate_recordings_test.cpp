#include "daemon/lab/simulate/simulate_recordings.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::simulate_recordings_test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class SimulateRecordings : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_);
    // The second point is outside of the room.
    std::ofstream(folder_ / "points.csv")
        << "t_start,t_end,x,y,z\n100,101,0.4,1.0,1.5\n200,201,9,0,1\n";
    const auto site = load_site(test::data_path("/sites/meeting_room"));
    ASSERT_TRUE(site) << site.error().message;
    site_ = *site;
    options_.points = folder_ / "points.csv";
    options_.outputs = {{"ap1", folder_ / "a.pcap"}};
    options_.transmissions.frames = 2;
    options_.trace.max_depth = 1;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_ =
      fs::path(::testing::TempDir()) / ("simulate_recordings_" + std::to_string(::getpid()));
  Site site_;
  SimulationOptions options_;
};

TEST_F(SimulateRecordings, ReturnsTheTruthAndReportsToTheObserver) {
  options_.truth = folder_ / "truth.csv";
  std::vector<std::string> notes;
  std::vector<double> shares;
  SimulationObserver observer;
  observer.on_note = [&](const std::string& note) { notes.push_back(note); };
  observer.on_progress = [&](double share, const std::string& stage) {
    EXPECT_EQ(stage, "ap1");
    shares.push_back(share);
  };
  const auto truth = simulate_recordings(site_, options_, observer);
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->captures.size(), 1U);
  EXPECT_THAT(truth->captures[0].lines_without_path, ElementsAre(3));
  EXPECT_GT(truth->captures[0].datagrams, 0U);
  EXPECT_EQ(truth->test_points.size(), 2U);
  EXPECT_FALSE(truth->is_walk);
  EXPECT_FALSE(truth->day);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("no path reaches ap1 from 1 points")));
  EXPECT_THAT(shares, ElementsAre(0.5, 1.0));
  EXPECT_GT(fs::file_size(folder_ / "a.pcap"), 0U);
  std::ifstream written(options_.truth);
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(written), {}),
              StartsWith("t_start,t_end,x,y,z\n100.000000000,101.000000000,0.400000,"));
}

TEST_F(SimulateRecordings, KeepsAFileUnlessForced) {
  ASSERT_TRUE(simulate_recordings(site_, options_, {}));
  const auto again = simulate_recordings(site_, options_, {});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::kUnavailable);
  options_.force = true;
  EXPECT_TRUE(simulate_recordings(site_, options_, {}));
}

TEST_F(SimulateRecordings, RefusesAnUnknownAccessPointBeforeItWrites) {
  options_.outputs.push_back({"ap9", folder_ / "b.pcap"});
  const auto refused = simulate_recordings(site_, options_, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_THAT(refused.error().message, HasSubstr("'ap9'"));
  EXPECT_FALSE(fs::exists(folder_ / "a.pcap"));
}

}  // namespace
}  // namespace rayloc::simulate_recordings_test
