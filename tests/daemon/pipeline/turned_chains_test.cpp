// What a pipeline states of devices when a receive chain of the only access point has turned: a
// simulated room, its survey and a device on 24 other places.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/calibrate/calibration_inputs.h"
#include "daemon/pipeline/device_estimator.h"
#include "tests/support/closet_plan.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/rayloc_process.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr double kQuarter = 0.5 * std::numbers::pi;
constexpr int kJumpAt = 30;  // the burst from which on the chain is turned
constexpr int kBursts = 60;

// Spots of half a second, two seconds apart: [x] of `columns`, [y] of `rows`.
std::string points(int begin, int columns, int rows, double shift) {
  std::string text = "t_start,t_end,x,y,z\n";
  for (int i = 0; i < columns * rows; ++i) {
    const int row = i / columns;
    const double x = -1.05 + shift + 2.0 * (i % columns) / columns;
    const double y = -0.85 + shift + 1.6 * row / rows;
    text += std::to_string(begin + 2 * i) + "," + std::to_string(begin + 2 * i) + ".5," +
            std::to_string(x) + "," + std::to_string(y) + ",1.2\n";
  }
  return text;
}

class TurnedChains : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    std::ofstream(path("plan.toml")) << test::closet_plan();
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    simulate("survey", points(1000, 6, 5, 0.0));
    run({"calibrate",
         path("site"),
         "--gains-only",
         "--quiet",
         "--points",
         path("survey.csv"),
         "--capture",
         "ap1=" + path("survey.pcap"),
         "--out",
         path("calibrated")});
    simulate("spots", points(3000, 10, 6, 0.11));
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static fs::path folder() {
    return fs::path(::testing::TempDir()) / ("turned_chains_" + std::to_string(::getpid()));
  }
  static std::string path(const std::string& name) { return folder() / name; }
  static void run(const std::vector<std::string>& arguments) {
    const Finished finished = RaylocProcess(arguments).wait();
    ASSERT_EQ(finished.status, 0) << finished.err;
  }
  static void simulate(const std::string& name, const std::string& csv) {
    std::ofstream(path(name + ".csv")) << csv;
    run({"simulate",
         path("site"),
         "--quiet",
         "--points",
         path(name + ".csv"),
         "--out",
         "ap1=" + path(name + ".pcap")});
  }
};

bool is_named(const Location& location) {
  for (const std::string& warning : location.estimate.warnings) {
    if (warning.find("chain_phase_jump: access point ap1, core 3 by 90 degrees") !=
        std::string::npos) {
      return true;
    }
  }
  return false;
}

TEST_F(TurnedChains, AreNamedAndNotBelieved) {
  const Site site = load_site(path("calibrated")).value();
  const auto captures = cli::resolve_captures({path("spots.pcap")}, {"ap1"}).value();
  const auto spots = cli::read_calibration_inputs(site, captures, path("spots.csv")).value();
  ASSERT_EQ(spots.points.size(), static_cast<std::size_t>(kBursts));
  const auto estimator = DeviceEstimator::create(site, {}).value();
  int located = 0;
  int named = 0;
  for (int i = 0; i < kBursts; ++i) {
    Burst burst;
    burst.frames = spots.points[static_cast<std::size_t>(i)].frames;
    ASSERT_FALSE(burst.frames.empty());
    if (i >= kJumpAt) {
      test::turn_chain(burst.frames, 0, 3, kQuarter);
    }
    burst.transmitter = burst.frames.front().transmitter;
    burst.first = burst.heard_since = burst.frames.front().time;
    burst.last = burst.frames.back().time;
    Estimates out;
    estimator->estimate(burst, out);
    ASSERT_FALSE(out.locations.empty());
    const Location& snapshot = out.locations.front();
    ASSERT_FALSE(snapshot.is_filtered());
    if (i < kJumpAt) {
      located += snapshot.estimate.position ? 1 : 0;
      EXPECT_FALSE(is_named(snapshot)) << i;
    } else if (is_named(snapshot)) {
      ++named;
      EXPECT_FALSE(snapshot.estimate.position) << i;
      EXPECT_NE(snapshot.estimate.reason, "");
      EXPECT_GT(snapshot.estimate.time, burst.first);
    }
  }
  EXPECT_EQ(located, kJumpAt);
  // A site that settled is looked at every ten seconds, so five spots pass before the first look.
  EXPECT_GE(named, (kBursts - kJumpAt) / 3);
  ASSERT_EQ(estimator->calibration_warnings().size(), 1U);
  const CalibrationWarning warning = estimator->calibration_warnings().front();
  EXPECT_EQ(warning.problem, CalibrationProblem::kChainPhaseJump);
  EXPECT_EQ(warning.core, 3);
  EXPECT_NEAR(warning.phase, kQuarter, 1e-9);

  Estimates none;
  estimator->restart("moved", none);
  EXPECT_TRUE(estimator->calibration_warnings().empty());
}

}  // namespace
}  // namespace rayloc
