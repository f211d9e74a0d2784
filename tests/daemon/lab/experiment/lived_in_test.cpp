// Studies of a room that people live in: heights, tilts, powers, a second day.
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/experiment/experiment_report.h"
#include "daemon/lab/experiment/run_experiment.h"
#include "daemon/lab/experiment/study_world.h"
#include "tests/daemon/lab/experiment/small_room.h"

namespace rayloc::lived_in_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LivedInStudy : public ::testing::Test {
 protected:
  LivedInStudy() : folder_("lived-in-test"), condition_(default_condition()) {
    condition_.room = folder_.path() / "room.toml";
    condition_.test_points = 3;
    condition_.frames = 1;
    condition_.depth = 1;
  }
  StudyLayout world() const {
    auto layouts = simulate_world(condition_, 1);
    EXPECT_TRUE(layouts) << layouts.error().message;
    return std::move(layouts->front());
  }
  // The first row of CSI of the first frame at the first test point.
  static std::vector<std::complex<float>> received(const StudyLayout& layout) {
    const auto row = layout.test_points.at(0).frames.at(0).csi.row(0, 0);
    return {row.begin(), row.end()};
  }
  Expected<Experiment> experiment(const std::string& study) const {
    return parse_experiment(
        "name = \"lived\"\n[defaults]\nroom = \"room.toml\"\nspots = 4\n"
        "frames = 2\ndepth = 1\nmodel_depth = 1\naccess_points = 2\n"
        "[[study]]\nname = \"one\"\n" +
            study,
        folder_.path() / "experiment.toml");
  }
  std::string refused(const std::string& study) const {
    const auto read = experiment(study);
    return read ? "nothing" : read.error().message;
  }

  test::SmallRoomFolder folder_;
  Condition condition_;
};

TEST_F(LivedInStudy, HeightsAreDrawnAroundTheModelHeight) {
  condition_.test_points = 400;
  condition_.depth = 0;
  const StudyLayout flat = world();
  condition_.height_sigma_m = 0.3;
  const StudyLayout layout = world();
  double sum = 0.0;
  double squares = 0.0;
  for (const StudyPoint& test_point : layout.test_points) {
    EXPECT_GE(test_point.position.z, 0.1);
    EXPECT_LE(test_point.position.z, 2.4);
    sum += test_point.position.z - 1.2;
    squares += std::pow(test_point.position.z - 1.2, 2);
  }
  EXPECT_NEAR(sum / 400, 0.0, 3 * 0.3 / 20);
  EXPECT_NEAR(std::sqrt(squares / 400), 0.3, 3 * 0.3 / 28);
  EXPECT_EQ(layout.test_points[0].position.x, flat.test_points[0].position.x);
  EXPECT_EQ(layout.model.device.height, 1.2);
  EXPECT_EQ(layout.model.device.height_sigma, 0.0);
  EXPECT_NE(received(layout), received(flat));
  condition_.model_height_sigma_m = 0.2;
  const StudyLayout expected = world();
  EXPECT_EQ(expected.model.device.height_sigma, 0.2);
  EXPECT_EQ(received(expected), received(layout));
}

TEST_F(LivedInStudy, TiltsAndPowersChangeReceivedFramesButNotPositions) {
  const StudyLayout plain = world();
  condition_.tilt_deg = 35;
  const StudyLayout tilted = world();
  condition_.tilt_deg = 0;
  condition_.power_sigma_db = 4;
  const StudyLayout varied = world();
  for (const StudyLayout* other : {&tilted, &varied}) {
    EXPECT_EQ(other->test_points[0].position, plain.test_points[0].position);
    EXPECT_NE(received(*other), received(plain));
  }
}

// The usual second day, in the model too: the response of each chain changes as a whole.
TEST_F(LivedInStudy, ASecondDayScalesEachChainAsAWhole) {
  const StudyLayout first = world();
  condition_.second_day = "default";
  const StudyLayout second = world();
  EXPECT_EQ(first.model.access_points[0].gains.gain, first.first_day_chains[0].gain);
  const ChainGains& now = second.model.access_points[0].gains;
  const ChainGains& then = second.first_day_chains[0];
  ASSERT_EQ(now.gain.size(), 3 * now.grid.size());
  for (std::size_t i = 0; i < now.gain.size(); ++i) {
    EXPECT_LT(std::abs(then.gain[i] - first.model.access_points[0].gains.gain[i]), 1e-12);
    const std::size_t start = i - i % now.grid.size();
    EXPECT_LT(std::abs(now.gain[i] / then.gain[i] - now.gain[start] / then.gain[start]), 1e-9);
  }
  EXPECT_GT(std::abs(now.gain[0] - then.gain[0]), 0.01);
  // The pose of the modelled array stays as it was surveyed.
  EXPECT_EQ(second.model.access_points[0].array.pose.position,
            first.model.access_points[0].array.pose.position);
  EXPECT_NE(received(second), received(first));
}

TEST_F(LivedInStudy, PeopleHaveASecondDayToo) {
  condition_.kind = "person";
  condition_.second_day = "default";
  const StudyLayout layout = world();
  EXPECT_FALSE(layout.empty.empty());
  EXPECT_NE(layout.model.access_points[0].gains.gain, layout.first_day_chains[0].gain);
}

TEST_F(LivedInStudy, NamesTheDayThatIsMissing) {
  condition_.second_day = "nowhere.toml";
  const auto layouts = simulate_world(condition_, 1);
  ASSERT_FALSE(layouts);
  EXPECT_THAT(layouts.error().message, HasSubstr("nowhere.toml"));
}

// From the file to the report: with the chains of the first day the error more than doubles.
TEST_F(LivedInStudy, RunsFromTheFileToTheReport) {
  folder_.write("cycle.toml", "base = \"none\"\nchain_phase_deg = 180\nchain_gain_db = 1.5\n");
  const auto file = experiment(
      "second_day = [\"none\", \"cycle.toml\"]\n"
      "chains = [\"known\", \"first_day\"]\n");
  ASSERT_TRUE(file) << file.error().message;
  const auto ignore = [](const Study&, std::size_t, const ConditionResult&) {};
  const auto results = run_experiment(*file, ignore);
  ASSERT_TRUE(results) << results.error().message;
  const auto& conditions = results->front().conditions;
  ASSERT_EQ(conditions.size(), 4U);
  const auto median = [&](std::size_t i) { return conditions[i].statistics.median_m; };
  EXPECT_EQ(median(0), median(1)) << "on the first day they are the same";
  EXPECT_LT(median(2), 0.15) << "known, they are as good as any";
  EXPECT_GT(median(3), 2.0 * median(2));
  EXPECT_THAT(experiment_csv(*results), HasSubstr(",second_day,person_radius_m,"));
  const auto again = run_experiment(*file, ignore);
  ASSERT_TRUE(again);
  EXPECT_EQ(experiment_json(*file, *again), experiment_json(*file, *results));
}

TEST_F(LivedInStudy, ReportsOfOtherStudiesHaveNoSuchColumns) {
  const Condition plain = default_condition();
  Condition lived = plain;
  lived.tilt_deg = 5;
  const std::vector<const Condition*> without = {&plain, &plain};
  const std::vector<const Condition*> with = {&plain, &lived};
  EXPECT_THAT(reported_keys(without), Not(::testing::Contains("tilt_deg")));
  EXPECT_THAT(reported_keys(with), ::testing::Contains("tilt_deg"));
  EXPECT_THAT(reported_keys(with), Not(::testing::Contains("second_day")));
  EXPECT_THAT(reported_keys(without), ::testing::Contains("paper.alpha"));
}

TEST_F(LivedInStudy, RefusesInvalidConditions) {
  EXPECT_THAT(refused("height_sigma_m = -0.1\n"), HasSubstr("height_sigma_m"));
  EXPECT_THAT(refused("tilt_deg = 200\n"), HasSubstr("tilt_deg"));
  EXPECT_THAT(refused("chains = \"yesterday\"\n"),
              HasSubstr("'yesterday' is no value of 'chains'"));
  EXPECT_THAT(refused("kind = \"person\"\nheight_sigma_m = 0.3\n"),
              HasSubstr("'height_sigma_m' is of devices"));
  EXPECT_THAT(refused("kind = \"person\"\npower_sigma_db = [0, 3]\n"),
              HasSubstr("'power_sigma_db' is of devices"));
}

}  // namespace
}  // namespace rayloc::lived_in_test
