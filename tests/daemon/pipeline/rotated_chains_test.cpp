// Tests the estimates of devices after the phase of a receive chain of the only access point has
// changed, until it is learned: a simulated room, its survey and a device at other places.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/pipeline/device/chain_file.h"
#include "daemon/pipeline/device_estimator.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/closet_plan.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::rotated_chains_test {
namespace {

namespace fs = std::filesystem;

constexpr double kQuarter = 0.5 * std::numbers::pi;
constexpr int kJumpAt = 30;  // the burst from which on the chain is rotated
constexpr int kBursts = 160;

// Points of half a second, two seconds apart: [x] of `columns`, [y] of `rows`.
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

class RotatedChains : public ::testing::Test {
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
    simulate("spots", points(3000, 16, 10, 0.05));
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static fs::path folder() {
    return fs::path(::testing::TempDir()) / ("rotated_chains_" + std::to_string(::getpid()));
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
    if (warning.find("chain_phase_jump: access point ap1: its chain phases have changed") !=
        std::string::npos) {
      return true;
    }
  }
  return false;
}

Burst burst_of(std::vector<CsiFrame> frames) {
  Burst burst;
  burst.frames = std::move(frames);
  burst.transmitter = burst.frames.front().transmitter;
  burst.first = burst.received_since = burst.frames.front().time;
  burst.last = burst.frames.back().time;
  return burst;
}

TEST_F(RotatedChains, AreUsedOnlyOnceLearnedAndThenKept) {
  const Site site = load_site(path("calibrated")).value();
  const auto captures = resolve_captures({path("spots.pcap")}, {"ap1"}).value();
  const auto surveyed = read_calibration_inputs(site, captures, path("spots.csv")).value();
  ASSERT_EQ(surveyed.points.size(), static_cast<std::size_t>(kBursts));
  DeviceEstimator::Options options;
  options.chains.write = path("chains.json");
  const auto estimator = DeviceEstimator::create(site, options).value();
  int located = 0;
  int learning = 0;
  int coarse = 0;
  int held = 0;
  for (int i = 0; i < kBursts; ++i) {
    auto frames = surveyed.points[static_cast<std::size_t>(i)].frames;
    ASSERT_FALSE(frames.empty());
    if (i >= kJumpAt) {
      test::turn_chain(frames, 0, 3, kQuarter);
    }
    const Burst burst = burst_of(std::move(frames));
    Estimates out;
    estimator->estimate(burst, out);
    ASSERT_FALSE(out.locations.empty());
    const LocationEstimate& snapshot = out.locations.front().estimate;
    ASSERT_FALSE(out.locations.front().is_filtered());
    if (i < kJumpAt) {
      located += snapshot.position ? 1 : 0;
      EXPECT_FALSE(is_named(out.locations.front())) << i;
    } else if (is_named(out.locations.front())) {
      ++learning;
      coarse += snapshot.position ? 1 : 0;
      const Vec3d truth = surveyed.points[static_cast<std::size_t>(i)].point.position;
      held += region_reaching(snapshot, truth).value_or(0.0) < 0.95 ? 1 : 0;
      // Without the phases the fix is coarse or missing; both state the reason.
      const std::string& why = snapshot.position ? snapshot.warnings.at(0) : snapshot.reason;
      EXPECT_NE(why.find("learning the chains of ap1: "), std::string::npos) << why;
      EXPECT_GT(snapshot.time, burst.first);
      EXPECT_EQ(estimator->calibration_warnings().at(0).problem,
                CalibrationProblem::kChainPhaseJump);
    }
  }
  EXPECT_EQ(located, kJumpAt);
  EXPECT_GE(held, 9 * learning / 10) << coarse << " coarse fixes of " << learning;
  std::string notices;
  for (const std::string& line : estimator->chain_notices()) {
    notices += line + "\n";
  }
  EXPECT_NE(
      notices.find("access point ap1: its chain phases have changed; learning the chains of ap1"),
      std::string::npos)
      << notices;
  EXPECT_NE(notices.find("access point ap1: its chains are learned"), std::string::npos) << notices;
  EXPECT_TRUE(estimator->calibration_warnings().empty());
  EXPECT_LT(learning, (kBursts - kJumpAt) / 2);

  // The next program begins with the chains learned here, also after a move of its recording.
  options.chains = {path("chains.json"), ""};
  const auto next = DeviceEstimator::create(site, options).value();
  Estimates moved;
  next->restart("moved", moved);
  const auto known = read_chain_file(path("chains.json"), next->room()).value();
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].knowledge, ChainKnowledge::kLearned);
  const auto& factor = known[0].factors.factor;
  EXPECT_NEAR(std::arg(factor[2] / factor[0]), kQuarter, 0.4);
  auto frames = surveyed.points[3].frames;
  test::turn_chain(frames, 0, 3, kQuarter);
  Estimates out;
  next->estimate(burst_of(std::move(frames)), out);
  EXPECT_TRUE(out.locations.at(0).estimate.position);

  std::ofstream(path("broken.json")) << "{";
  EXPECT_FALSE(read_chain_file(path("broken.json"), next->room()));
  EXPECT_TRUE(read_chain_file(path("none.json"), next->room()).value().empty());
}

}  // namespace
}  // namespace rayloc::rotated_chains_test
